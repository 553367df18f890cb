// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/values/function.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "host_shim/formats/pov/values/spline.h"
#include "host_shim/formats/pov/values/transform_of.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {
namespace {

using Arguments = std::span<const double>;

struct BuiltIn {
    std::string_view name;
    std::size_t least, most;
    double (*of)(Arguments);
};

double remainder(double a, double b) {
    return b == 0 ? 0 : std::fmod(a, b);
}
double degreesOf(double radians) {
    return radians * 180 / std::numbers::pi;
}
int wholeOf(double value) {
    return static_cast<int>(std::clamp(value, -2147483648.0, 2147483647.0));
}
template <typename Op>
double overBits(Arguments a, Op op) {
    int result = wholeOf(a[0]);
    for (std::size_t i = 1; i < a.size(); ++i) result = op(result, wholeOf(a[i]));
    return result;
}

constexpr std::size_t kAny = 64;
constexpr std::array<BuiltIn, 35> kBuiltIns{{
    {"abs", 1, 1, [](Arguments a) { return std::abs(a[0]); }},
    {"acos", 1, 1, [](Arguments a) { return std::acos(a[0]); }},
    {"acosh", 1, 1, [](Arguments a) { return std::acosh(a[0]); }},
    {"asin", 1, 1, [](Arguments a) { return std::asin(a[0]); }},
    {"asinh", 1, 1, [](Arguments a) { return std::asinh(a[0]); }},
    {"atan", 1, 1, [](Arguments a) { return std::atan(a[0]); }},
    {"atan2", 2, 2, [](Arguments a) { return std::atan2(a[0], a[1]); }},
    {"atanh", 1, 1, [](Arguments a) { return std::atanh(a[0]); }},
    {"bitwise_and", 2, kAny,
     [](Arguments a) { return overBits(a, [](int x, int y) { return x & y; }); }},
    {"bitwise_or", 2, kAny,
     [](Arguments a) { return overBits(a, [](int x, int y) { return x | y; }); }},
    {"bitwise_xor", 2, kAny,
     [](Arguments a) { return overBits(a, [](int x, int y) { return x ^ y; }); }},
    {"ceil", 1, 1, [](Arguments a) { return std::ceil(a[0]); }},
    {"cos", 1, 1, [](Arguments a) { return std::cos(a[0]); }},
    {"cosh", 1, 1, [](Arguments a) { return std::cosh(a[0]); }},
    {"degrees", 1, 1, [](Arguments a) { return degreesOf(a[0]); }},
    {"div", 2, 2, [](Arguments a) { return a[1] == 0 ? 0 : std::trunc(a[0] / a[1]); }},
    {"exp", 1, 1, [](Arguments a) { return std::exp(a[0]); }},
    {"floor", 1, 1, [](Arguments a) { return std::floor(a[0]); }},
    {"int", 1, 1, [](Arguments a) { return std::trunc(a[0]); }},
    {"ln", 1, 1, [](Arguments a) { return std::log(a[0]); }},
    {"log", 1, 1, [](Arguments a) { return std::log10(a[0]); }},
    {"max", 2, kAny, [](Arguments a) { return *std::ranges::max_element(a); }},
    {"min", 2, kAny, [](Arguments a) { return *std::ranges::min_element(a); }},
    {"mod", 2, 2, [](Arguments a) { return remainder(a[0], a[1]); }},
    {"pow", 2, 2, [](Arguments a) { return std::pow(a[0], a[1]); }},
    {"radians", 1, 1, [](Arguments a) { return a[0] * std::numbers::pi / 180; }},
    {"select", 3, 4,
     [](Arguments a) {
         if (a[0] < 0) return a[1];
         return a.size() == 4 && a[0] > 0 ? a[3] : a[2];
     }},
    {"sin", 1, 1, [](Arguments a) { return std::sin(a[0]); }},
    {"sinh", 1, 1, [](Arguments a) { return std::sinh(a[0]); }},
    {"sqr", 1, 1, [](Arguments a) { return a[0] * a[0]; }},
    {"sqrt", 1, 1, [](Arguments a) { return std::sqrt(a[0]); }},
    {"tan", 1, 1, [](Arguments a) { return std::tan(a[0]); }},
    {"tanh", 1, 1, [](Arguments a) { return std::tanh(a[0]); }},
    // Their terms are evaluated again and again, so by Evaluation.
    {"sum", 4, 4, nullptr},
    {"prod", 4, 4, nullptr},
}};

const BuiltIn* findBuiltIn(std::string_view text) {
    const auto found = std::ranges::find(kBuiltIns, text, &BuiltIn::name);
    return found == kBuiltIns.end() ? nullptr : &*found;
}

[[noreturn]] void fail(const Function& function, std::string_view why) {
    throw HostError(ExitCode::kBadInput,
                    fmt::format("function {}: {}",
                                function.name.empty() ? "without a name" : function.name, why));
}

class Evaluation {
  public:
    Numbers of(const Function& function, Arguments arguments) {
        if (++m_depth > kMostCalls) fail(function, "calls go deeper than 256");
        count(function);
        Numbers result;
        if (function.spline) {
            result = function.spline->at(arguments[0], function.spline->kind);
        } else if (function.node && function.node->kind == "transform") {
            const auto to = transformed(transformOfItems(*function.node),
                                        {arguments[0], arguments[1], arguments[2]});
            result = Numbers::vector(to[0], to[1], to[2]);
        } else if (!function.isExpression()) {
            fail(function, function.node ? "a " + std::string(function.node->kind) +
                                               " that is asked while parsing waits for patterns"
                                         : fmt::format("internal({}) waits for shapes and patterns",
                                                       function.internal));
        } else {
            // Of an expression the variables of sums follow the parameters.
            std::vector<double> variables(arguments.begin(), arguments.end());
            result = Numbers::of(number(function, function.expression, variables));
        }
        --m_depth;
        return result;
    }

  private:
    static constexpr int kMostCalls = 256;

    void count(const Function& of) {
        constexpr std::uint64_t kMostSteps = 10'000'000;
        if (++m_steps > kMostSteps) fail(of, "more than 10^7 calls and terms of sums in one value");
    }

    double number(const Function& of, const FunctionTerm& term, std::vector<double>& variables) {
        switch (term.kind) {
            case FunctionTerm::Kind::kNumber:
                return term.number;
            case FunctionTerm::Kind::kParameter:
                return variables[term.index];
            case FunctionTerm::Kind::kOperation:
                return operation(of, term, variables);
            case FunctionTerm::Kind::kBuiltIn:
                return builtInOf(of, term, variables);
            case FunctionTerm::Kind::kCall:
                return call(of, term, variables).at[0];
            case FunctionTerm::Kind::kComponent:
                break;
        }
        return component(call(of, term.terms[0], variables), term);
    }

    double operation(const Function& of, const FunctionTerm& term, std::vector<double>& variables) {
        const double first = number(of, term.terms[0], variables);
        if (term.terms.size() == 1)
            return term.text == "-" ? -first : std::abs(first) <= kEpsilon ? 1.0 : 0.0;
        const double second = number(of, term.terms[1], variables);
        return combined(Numbers::of(first), term.text[0], Numbers::of(second)).at[0];
    }

    double builtInOf(const Function& of, const FunctionTerm& term, std::vector<double>& variables) {
        if (term.text == "sum" || term.text == "prod") return repeated(of, term, variables);
        std::array<double, kAny> values{};
        for (std::size_t i = 0; i < term.terms.size(); ++i)
            values[i] = number(of, term.terms[i], variables);
        return builtIn(term.text, {values.data(), term.terms.size()});
    }

    double repeated(const Function& of, const FunctionTerm& term, std::vector<double>& variables) {
        const double begin = number(of, term.terms[0], variables);
        const double end = number(of, term.terms[1], variables);
        if (variables.size() <= term.index) variables.resize(term.index + 1);
        const bool isSum = term.text == "sum";
        double result = isSum ? 0 : 1;
        for (double i = begin; i <= end; ++i) {
            count(of);
            variables[term.index] = i;
            const double value = number(of, term.terms[2], variables);
            result = isSum ? result + value : result * value;
        }
        return result;
    }

    Numbers call(const Function& of, const FunctionTerm& term, std::vector<double>& variables) {
        std::vector<double> values;
        for (const FunctionTerm& argument : term.terms)
            values.push_back(number(of, argument, variables));
        return this->of(*term.function, values);
    }

    static double component(const Numbers& value, const FunctionTerm& term) {
        return term.text == "gray" ? gray(value) : value.at[term.index];
    }

    int m_depth = 0;
    std::uint64_t m_steps = 0;
};

std::string joined(const std::vector<FunctionTerm>& terms);

std::string printed(const FunctionTerm& term) {
    switch (term.kind) {
        case FunctionTerm::Kind::kNumber:
            return fmt::format("{}", term.number);
        case FunctionTerm::Kind::kParameter:
            return term.text;
        case FunctionTerm::Kind::kOperation: {
            if (term.terms.size() == 1)
                return fmt::format("({}{})", term.text, printed(term.terms[0]));
            constexpr std::string_view kShort = "lgn";
            constexpr std::array<std::string_view, 3> kLong{"<=", ">=", "!="};
            const std::size_t which = kShort.find(term.text);
            return fmt::format("({} {} {})", printed(term.terms[0]),
                               which < kLong.size() ? kLong[which] : std::string_view(term.text),
                               printed(term.terms[1]));
        }
        case FunctionTerm::Kind::kBuiltIn:
            if (term.text == "sum" || term.text == "prod")
                return fmt::format("{}(#{}, {})", term.text, term.index, joined(term.terms));
            return fmt::format("{}({})", term.text, joined(term.terms));
        case FunctionTerm::Kind::kCall:
            return fmt::format("({})({})", printed(*term.function), joined(term.terms));
        case FunctionTerm::Kind::kComponent:
            break;
    }
    return fmt::format("{}.{}", printed(term.terms[0]), term.text);
}

std::string joined(const std::vector<FunctionTerm>& terms) {
    std::string text;
    for (const FunctionTerm& term : terms) text += (text.empty() ? "" : ", ") + printed(term);
    return text;
}

}  // namespace

std::string printed(const Function& function) {
    if (function.internal >= 0)
        return fmt::format("function {{ internal({}) }}", function.internal);
    if (function.node) return fmt::format("function {{ {} }}", printed(*function.node));
    if (function.spline) return fmt::format("function {{ {} }}", printed(Value(function.spline)));
    return fmt::format("function ({}) {{ {} }}", fmt::join(function.parameters, ", "),
                       printed(function.expression));
}

bool isFunctionBuiltIn(std::string_view text, std::size_t& least, std::size_t& most) {
    const BuiltIn* const found = findBuiltIn(text);
    if (found == nullptr) return false;
    least = found->least;
    most = found->most;
    return true;
}

double builtIn(std::string_view text, std::span<const double> arguments) {
    return findBuiltIn(text)->of(arguments);
}

Numbers evaluated(const Function& function, std::span<const double> arguments) {
    return Evaluation().of(function, arguments);
}

}  // namespace pm::host::pov
