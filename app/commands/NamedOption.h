#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands/Options.h"

namespace app {

template <typename T>
struct EnumOf {
    using Type = T;
};
template <typename T>
struct EnumOf<std::optional<T>> {
    using Type = T;
};

/// An option whose value is one of these names; another is refused, with the nearest one that there is.
template <typename Target, std::size_t count>
void addNamed(CLI::App& parser, const std::string& option, Target& target,
              const std::array<std::string_view, count>& names, const std::string& description) {
    std::string list;
    for (std::string_view name : names) list += (list.empty() ? "" : " ") + std::string(name);
    parser
        .add_option_function<std::string>(
            option,
            [&target, names, option, list](const std::string& text) {
                const auto value = fromName<typename EnumOf<Target>::Type>(names, text);
                if (!value) {
                    const std::vector<std::string> all(names.begin(), names.end());
                    const auto meant = suggestion(text, all);
                    throw CLI::ValidationError(option,
                                               "there is no '" + text + "'; choose from: " + list +
                                                   (meant ? " (did you mean '" + *meant + "'?)" : ""));
                }
                target = *value;
            },
            description + ": " + list)
        ->type_name("NAME");
}

}  // namespace app
