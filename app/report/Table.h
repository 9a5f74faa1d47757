#pragma once

#include <string>
#include <vector>

namespace app {

/// Rows of text in aligned columns: the first column to the left, the others to the right, a rule under the
/// first row. Rows may differ in length. Widths count UTF-8 code points.
std::string formatTable(const std::vector<std::vector<std::string>>& rows);

/// A number with a fixed count of decimals; "-" when it is not finite.
std::string fixed(double value, int decimals);
/// A size in bytes for people: "512 B", "1.5 KiB", "20.0 MiB".
std::string byteSize(double bytes);

}  // namespace app
