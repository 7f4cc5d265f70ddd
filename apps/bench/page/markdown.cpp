#include "apps/bench/page/markdown.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway::bench {
namespace {

/// Characters of UTF-8.
std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Of a column: how wide it is, and whether its cells are numbers.
struct Column {
  std::size_t width = 3;
  bool is_number = true;
};

bool begins_as_number(const std::string& cell) {
  if (cell.empty() || cell.starts_with("–")) return true;
  const std::size_t first = cell.front() == '-' ? 1 : 0;
  return first < cell.size() && std::isdigit(static_cast<unsigned char>(cell[first])) != 0;
}

std::string line_of(const std::vector<std::string>& cells, const std::vector<Column>& columns) {
  std::string line = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string cell = escaped(cells[i]), space(columns[i].width - shown_width(cell), ' ');
    line += ' ' + (columns[i].is_number ? space + cell : cell + space) + " |";
  }
  return line + '\n';
}

std::vector<Column> columns_of(const Table& table) {
  std::vector<Column> columns(table.head.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns[i].width = std::max(columns[i].width, shown_width(escaped(table.head[i])));
    for (const auto& row : table.rows) {
      if (row.size() != columns.size())
        throw std::invalid_argument("table '" + table.title + "': a row has " + std::to_string(row.size()) +
                                    " cells, expected " + std::to_string(columns.size()));
      columns[i].width = std::max(columns[i].width, shown_width(escaped(row[i])));
      columns[i].is_number = columns[i].is_number && begins_as_number(row[i]);
    }
  }
  return columns;
}

std::string with_thousands(const std::string& digits) {
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '|') safe += '\\';
    safe += c == '\n' || c == '\r' ? ' ' : c;
  }
  return safe;
}

std::string to_markdown(const Table& table) {
  const std::vector<Column> columns = columns_of(table);
  std::string text = table.title.empty() ? "" : wrapped(table.title) + "\n\n";
  text += line_of(table.head, columns) + '|';
  for (const Column& column : columns)
    text += std::string(column.width + 1, '-') + (column.is_number ? ":|" : "-|");
  text += '\n';
  for (const auto& row : table.rows) text += line_of(row, columns);
  return text + (table.note.empty() ? "" : '\n' + wrapped(table.note) + '\n');
}

std::string figure(double value) {
  if (!std::isfinite(value)) return "–";
  const double size = std::abs(value);
  const int decimals = size >= 99.95 || size == 0.0 ? 0 : size >= 9.995 ? 1 : 2;
  char text[64];
  if (size > 0.0 && size < 0.001) {
    std::snprintf(text, sizeof text, "%.1e", value);
    return text;
  }
  if (size > 0.0 && size < 0.9995) {
    std::snprintf(text, sizeof text, "%.*f", size < 0.01 ? 4 : size < 0.1 ? 3 : 2, value);
    return text;
  }
  std::snprintf(text, sizeof text, "%.*f", decimals, size);
  return (value < 0.0 ? "-" : "") + (decimals == 0 ? with_thousands(text) : std::string(text));
}

std::string count_text(double count) {
  char text[64];
  std::snprintf(text, sizeof text, "%.0f", count);
  return with_thousands(text);
}

std::string percent(double share) { return figure(100.0 * share) + " %"; }

std::string length_text(double metres) {
  return metres < 0.00999 ? short_text(1e3 * metres) + " mm" : short_text(1e2 * metres) + " cm";
}

std::string wrapped(const std::string& text) {
  constexpr std::size_t widest = 118;
  std::istringstream words(text);
  std::string lines, line;
  for (std::string word; words >> word;) {
    if (!line.empty() && shown_width(line) + 1 + shown_width(word) > widest) {
      lines += line + '\n';
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + line;
}

}  // namespace clearway::bench
