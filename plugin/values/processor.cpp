// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/processor.h"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

#include <cstring>

namespace pm::plugin {

namespace {

std::string askProcessor() {
#if defined(__x86_64__) || defined(__i386__)
    unsigned int most = 0;
    unsigned int registers[3] = {};  // in the order of the name's letters: ebx, edx, ecx
    if (__get_cpuid(0, &most, &registers[0], &registers[2], &registers[1]) != 0) {
        char name[sizeof(registers) + 1] = {};
        std::memcpy(name, registers, sizeof(registers));
        for (const char c : std::string(name))
            if (c < ' ' || c > '~') return "unknown";
        if (name[0] != '\0') return name;
    }
#endif
    return "unknown";
}

}  // namespace

const std::string& processorVendor() {
    static const std::string vendor = askProcessor();
    return vendor;
}

}  // namespace pm::plugin
