#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace clearway {

/// Rows of (name, text) as an aligned two-column table.
void print_rows(std::ostream& out, const std::vector<std::pair<std::string, std::string>>& rows);

/// A table with a header row; columns are as wide as their widest cell (counted in UTF-8 characters).
void print_table(std::ostream& out, const std::vector<std::vector<std::string>>& rows);

}  // namespace clearway
