// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/api/parameter_reader.h"

#include <fmt/format.h>

#include <cstring>

#include "plugin/api/entry.h"
#include "plugin/api/objects.h"
#include "plugin/api/transform_reader.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

template <typename Member>
Member memberAt(const void* desc, std::size_t offset) {
    Member member;
    std::memcpy(&member, static_cast<const std::byte*>(desc) + offset, sizeof member);
    return member;
}

template <typename Number>
void readNumbers(const void* desc, std::size_t offset, std::uint32_t count, ParameterValue& value) {
    for (std::uint32_t i = 0; i < count; ++i)
        value.numbers.push_back(
            static_cast<double>(memberAt<Number>(desc, offset + i * sizeof(Number))));
}

}  // namespace

std::shared_ptr<const Texture> findTexture(const Context& context, PmrTexture handle,
                                           const std::string& member) {
    if (handle == nullptr) return nullptr;
    const auto texture = findObject<TextureObject>(handle);
    if (!texture)
        throw CallError(CallStatus::kHandle, fmt::format("{} is not a live texture", member));
    if (texture->context().get() != &context)
        throw argumentError(fmt::format("{} belongs to another context", member));
    return texture->texture();
}

ParameterValue readMember(const void* desc, const StructPlace& place, const ParameterInfo& info,
                          const Context& context, const std::string& type) {
    using Kind = StructPlace::Kind;
    ParameterValue value;
    switch (place.kind) {
        case Kind::kFloats:
            readNumbers<float>(desc, place.offset, info.count, value);
            break;
        case Kind::kDoubles:
            readNumbers<double>(desc, place.offset, info.count, value);
            break;
        case Kind::kInt32:
            readNumbers<std::int32_t>(desc, place.offset, info.count, value);
            break;
        case Kind::kUint32:
            readNumbers<std::uint32_t>(desc, place.offset, info.count, value);
            break;
        case Kind::kText:
            if (const auto* text = memberAt<const char*>(desc, place.offset)) value.text = text;
            break;
        case Kind::kTransform: {
            const auto* transforms = memberAt<const double*>(desc, place.offset);
            const auto samples = memberAt<std::uint64_t>(desc, place.offset + sizeof transforms);
            const Transform transform = readTransform(transforms, samples, type.c_str());
            value.numbers.assign(transform.begin(), transform.end());
            break;
        }
        case Kind::kTexture:
            value.texture = findTexture(context, memberAt<PmrTexture>(desc, place.offset),
                                        fmt::format("{}: {}", type, info.name));
            break;
        case Kind::kNone:
            break;
    }
    return value;
}

ParameterValue givenValue(const ParameterInfo& info, const PmrParameterDesc& desc,
                          const Context& context, const std::string& owner) {
    const bool hasNumbers = desc.numbers != nullptr || desc.numberCount > 0;
    const bool hasTexture = desc.texture != nullptr || info.type == ParameterType::kTexture;
    if (hasNumbers + (desc.text != nullptr) + hasTexture != 1)
        throw argumentError(
            fmt::format("{}: {} is set to numbers, a text or a texture; it must be "
                        "one of them, and is {}",
                        owner, info.name, allowedText(info)));
    if (desc.text != nullptr) return parseValue(info, desc.text, owner);
    ParameterValue value;
    if (hasTexture) {
        value.texture = findTexture(context, desc.texture, fmt::format("{}: {}", owner, info.name));
        return value;
    }
    if (desc.numbers == nullptr || desc.numberCount != info.count)
        throw argumentError(fmt::format("{}: {} is set to {} numbers{}; it must be {} of them",
                                        owner, info.name, desc.numberCount,
                                        desc.numbers == nullptr ? " at null" : "", info.count));
    value.numbers.assign(desc.numbers, desc.numbers + desc.numberCount);
    return value;
}

}  // namespace pm::plugin
