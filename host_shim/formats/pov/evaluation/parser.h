// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/formats/pov/evaluation/symbols.h"
#include "host_shim/formats/pov/evaluation/text_file.h"
#include "host_shim/formats/pov/lexer/token.h"
#include "host_shim/formats/pov/values/function.h"
#include "host_shim/formats/pov/values/spline.h"
#include "host_shim/formats/pov/values/value.h"
#include "host_shim/values/go_on.h"

namespace pm::host::pov {

// What a scene may take, so that a hostile one ends with a message.
struct Limits {
    std::uint64_t bytesOfFile = 128u << 20;
    std::uint64_t tokensOfFile = 16'000'000;
    std::uint64_t iterations = 5'000'000;  // of all loops and calls of macros together
    std::uint64_t elementsOfArrays = 20'000'000;
    std::uint64_t charactersOfString = 1u << 20;
    std::uint32_t depth = 200;  // of blocks, include files, macros and expressions in each other
    double seconds = 120;
};

// Who reads files for the parser, and hears what the scene says.
struct Surroundings {
    // The file that a scene means by a name, and its text; none: there is none, or it may not be
    // read. Errors: as readWholeFile.
    std::function<std::optional<std::string>(const std::string& name)> find;
    std::function<std::string(const std::string& file)> read;
    // Where #fopen ... write and append may write by a name; none: nowhere.
    std::function<std::optional<std::string>(const std::string& name)> writable;
    std::function<void(const std::string& text)> debug;  // of #debug and the like
    std::function<void(const Place& place, const std::string& text)> warn;
    GoOn goOn;
    std::map<std::string, Numbers> variables;  // clock, image_width, ... by their words
    std::map<std::string, Value> declared;     // by Declare= of an .ini
    std::string inputFileName;
    double version = 3.62;
    Limits limits;
};

// A scene that was evaluated.
struct Evaluated {
    std::vector<std::shared_ptr<const Node>> statements;  // in their order
    std::shared_ptr<const Node> defaultTexture;           // by #default; may be nullptr
};

// Reads the language: directives as they come, and statements as values. For one scene; not for
// several threads.
// Errors: kBadInput, "FILE:LINE:COLUMN: what", with the include files and macros around it.
class Parser {
  public:
    Parser(Surroundings surroundings, Names& names);
    ~Parser();
    Parser(const Parser&) = delete;
    Parser& operator=(const Parser&) = delete;

    Evaluated run(std::string_view text, const std::string& file);

  private:
    using NodePtr = std::shared_ptr<const Node>;

    // A text that is being read: the scene's file, an include file or the body of a macro.
    struct Frame {
        std::shared_ptr<const Source> source;
        std::size_t at{};
        std::size_t firstBlock{};  // of m_blocks, those of this frame
        std::string what;          // "macro NAME", or empty for files
        Place from;                // where it was called
    };
    // An #if, #switch, #while or #for whose #end is to come.
    struct Block {
        enum class Kind { kIf, kSwitch, kWhile, kFor };
        Kind kind{};
        std::size_t opener{};  // its token
        bool isTaken{};        // a branch was taken
        double value{};        // of a switch
        NameId variable{};     // of a #for
        double end{}, step{};
        std::uint32_t depth{};  // of the table that the variable is in
    };
    // A token, and the text that it stands in (which m_sources keeps).
    struct Lexeme : Token {
        const Source* source{};
    };
    // Of a macro's call.
    struct Argument {
        Value value;
        bool isReference{};
        Symbols::Slot slot;
    };
    class Deeper;

    // --- tokens (token_stream.cpp)
    const Lexeme& peek();
    const Lexeme& peekOperator();
    bool hasToWait(const Lexeme& directive) const;
    Lexeme next();
    Lexeme raw();  // neither directives nor macros are looked at
    Place placeOf(const Lexeme& token) const;
    [[noreturn]] void fail(const Place& place, const std::string& text) const;
    [[noreturn]] void fail(const std::string& text) const { fail(m_place, text); }
    [[noreturn]] void expected(const Lexeme& token, std::string_view what) const;
    std::string shown(const Lexeme& token) const;
    bool isSymbol(const Lexeme& token, char symbol) const {
        return token.kind == TokenKind::kSymbol && token.symbol == symbol;
    }
    bool isWord(const Lexeme& token, std::string_view word) const;
    bool takeSymbol(char symbol);
    // Of the text itself, no directive obeyed: the token that comes behind what was peeked.
    bool isBehind(char symbol) const;
    // The same of the token that comes next.
    bool isNext(char symbol) const {
        return m_peeked ? isSymbol(*m_peeked, symbol) : isBehind(symbol);
    }
    bool takeWord(std::string_view word);
    void expectSymbol(char symbol);
    const std::string& wordOf(const Lexeme& token) const { return m_names.text(token.name); }
    void warn(const std::string& text) { m_around.warn(m_place, text); }
    void count();
    void countIteration();
    Frame& frame() { return m_frames.back(); }
    void enterSource(std::shared_ptr<const Source> source, std::size_t at, std::string what);
    void leaveFrame();
    bool endOfText(const Lexeme& token);

    // --- directives (directives.cpp, blocks_of_directives.cpp, declarations.cpp)
    void directive(const Lexeme& token);
    void undefine();
    void branch(const Lexeme& token);
    void takeBranch(std::size_t at);
    void open(Block::Kind kind);
    void beginIf(const Lexeme& token);
    void beginSwitch();
    void beginWhile();
    void beginFor();
    bool clause(bool isRange);
    void chooseClause();
    void endBlock();
    void breakOut();
    void skipTo(std::size_t token) { frame().at = token; }
    std::size_t endOf(std::size_t opener) const;
    bool condition();
    bool isDefined();
    void declareName(bool isLocal);
    void takeSemicolon();
    Value own(Value value);
    void defineMacro();
    Argument macroArgument();
    void callMacro(const std::shared_ptr<const Macro>& macro, const Lexeme& name);
    void include();
    void setVersion();
    void setDefault();
    void message(const std::string& word);
    void openFile();
    void closeFile();
    void readFromFile();
    void writeToFile();
    std::shared_ptr<TextFile> fileHandle(NameId& name);

    // --- values (expressions.cpp, built_ins.cpp, texts.cpp, rvalues.cpp)
    Value rvalue();
    std::optional<Value> rvalueOfWord(const Lexeme& token);
    std::shared_ptr<Array> arrayValue();
    void arrayElements(Array& array, std::size_t dimension, std::size_t& at);
    std::shared_ptr<const Spline> splineValue();
    Value* element(Array& array);
    Value* resolved(const Lexeme& name);  // with its [ ] behind it
    bool beginsNumbers(const Lexeme& token);
    bool beginsText(const Lexeme& token);
    Numbers expression(bool relations = false);
    Numbers expressionFrom(const Numbers& first);
    Numbers sum(const Numbers* first);
    Numbers product(const Numbers* first);
    Numbers factor();
    Numbers withComponents(Numbers value);
    Numbers operand(const Lexeme& token);
    Numbers operandOfWord(const Lexeme& token);
    Numbers operandOfName(const Lexeme& token);
    Numbers conditional();
    Numbers logical();
    Numbers relation();
    Numbers colour(const Lexeme& token);
    Numbers colourComponents(Numbers colour);
    Numbers colourVector(const std::string& word);
    std::vector<double> literal();  // behind <
    Numbers numberFunction(const Lexeme& token);
    Numbers vectorFunction(const std::string& word);
    Numbers textAsNumber(const std::string& word);
    Numbers randomNumber(bool isSeed);
    Numbers callFunction(const Function& function);
    Numbers callSpline(const Spline& spline);
    double number();  // the first component
    Numbers vector(std::size_t components) { return expression().promoted(components); }
    std::string text(bool isFileName = false);
    std::string textFunction(const std::string& word);
    std::string formatted(double value, int least, int digits) const;
    std::string datetime();
    std::string unescaped(const std::string& text, bool isFileName) const;

    // --- functions of the scene (function_expressions.cpp)
    class FunctionReader;
    std::shared_ptr<const Function> functionValue();

    // --- statements (statements.cpp)
    NodePtr statement(const Lexeme& word);
    void body(Node& node, char closing);
    std::shared_ptr<Node> begunNode(const Lexeme& word);
    void item(Node& node, const Lexeme& token, std::shared_ptr<Node>& open);
    void values(Node& node, std::shared_ptr<Node>& open);
    bool isItem(const Node& node, const Lexeme& token);
    // Counts a value into the depth of what holds it.
    void hold(std::uint32_t& depth, std::uint32_t held);

    Surroundings m_around;
    Names& m_names;
    Symbols m_symbols;
    std::vector<Frame> m_frames;
    std::vector<Block> m_blocks;
    std::optional<Lexeme> m_peeked;
    bool m_isForOperator{};  // next() is asked by peekOperator()
    Place m_place;           // of the last token
    std::map<std::string, std::shared_ptr<const Source>> m_sources;
    std::map<std::string, std::shared_ptr<std::string>> m_written;  // by #write, of each file
    std::vector<std::uint32_t> m_random;                            // of each stream
    std::uint64_t m_tokens{}, m_iterations{}, m_elements{};
    std::uint32_t m_depth{};
    double m_version;
    NodePtr m_defaultTexture;
    std::chrono::steady_clock::time_point m_begin;
    bool m_warnedOfDivision{};
};

struct Macro {
    std::string name;
    std::vector<NameId> parameters;
    std::shared_ptr<const Source> source;
    std::size_t begin{}, end{};  // tokens; end: its #end
};

// Counts how deep things stand in each other.
class Parser::Deeper {
  public:
    explicit Deeper(Parser& parser) : m_parser(parser) {
        if (++parser.m_depth > parser.m_around.limits.depth)
            parser.fail("deeper than " + std::to_string(parser.m_around.limits.depth) +
                        " blocks, macros or parentheses in each other");
    }
    ~Deeper() { --m_parser.m_depth; }
    Deeper(const Deeper&) = delete;
    Deeper& operator=(const Deeper&) = delete;

  private:
    Parser& m_parser;
};

}  // namespace pm::host::pov
