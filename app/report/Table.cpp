#include "app/report/Table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace app {

namespace {

std::size_t widthOf(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string formatTable(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths;
    for (const auto& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (c == widths.size()) widths.push_back(0);
            widths[c] = std::max(widths[c], widthOf(row[c]));
        }
    std::string text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        std::string line;
        for (std::size_t c = 0; c < rows[r].size(); ++c) {
            const std::string padding(widths[c] - widthOf(rows[r][c]), ' ');
            line += (c == 0 ? "" : "  ") + (c == 0 ? rows[r][c] + padding : padding + rows[r][c]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
        if (r == 0 && rows.size() > 1) {
            std::size_t total = 0;
            for (std::size_t w : widths) total += w + 2;
            text += std::string(total > 2 ? total - 2 : 0, '-') + "\n";
        }
    }
    return text;
}

std::string fixed(double value, int decimals) {
    if (!std::isfinite(value)) return "-";
    // 309 digits before the point at most.
    std::array<char, 400> text{};
    std::snprintf(text.data(), text.size(), "%.*f", std::clamp(decimals, 0, 30), value);
    return text.data();
}

std::string byteSize(double bytes) {
    constexpr std::array<const char*, 5> units{"B", "KiB", "MiB", "GiB", "TiB"};
    std::size_t unit = 0;
    while (unit + 1 < units.size() && bytes >= 1024) {
        bytes /= 1024;
        ++unit;
    }
    return fixed(bytes, unit == 0 ? 0 : 1) + " " + units[unit];
}

}  // namespace app
