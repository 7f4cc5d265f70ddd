#include "apps/console/table.hpp"

#include <algorithm>

namespace clearway {

namespace {

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace

void print_rows(std::ostream& out, const std::vector<std::pair<std::string, std::string>>& rows) {
  std::size_t width = 0;
  for (const auto& [name, text] : rows) width = std::max(width, width_of(name));
  for (const auto& [name, text] : rows) {
    out << "  " << name << std::string(width - width_of(name) + 2, ' ') << text << '\n';
  }
}

void print_table(std::ostream& out, const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::string line = " ";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      line += ' ' + rows[r][c];
      if (c + 1 < rows[r].size()) line += std::string(widths[c] - width_of(rows[r][c]) + 1, ' ');
    }
    out << line << '\n';
    if (r == 0) {
      std::size_t total = 0;
      for (const std::size_t width : widths) total += width + 2;
      out << "  " << std::string(total - 2, '-') << '\n';
    }
  }
}

}  // namespace clearway
