#pragma once

#include <string>
#include <vector>

namespace clearway::bench {

/// A table of a page. All rows have as many cells as the head.
struct Table {
  std::string title;  ///< stands above; may be empty
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::string note{};  ///< stands below; may be empty
};

/// A cell's text: no pipe and no line end of it ends the cell.
std::string escaped(const std::string& text);

/// The table as GitHub's Markdown has it: columns as wide as their widest cell; those of numbers to the
/// right.
/// @throws std::invalid_argument for a row that is longer or shorter than the head.
std::string to_markdown(const Table& table);

/// Three digits, thousands apart: 3,677, 12.4, 0.031. A dash for what is no number.
std::string figure(double value);

/// A whole number, thousands apart.
std::string count_text(double count);

/// A share of one as percent: 8.70 %.
std::string percent(double share);

/// A length as one says it: 2 cm, 2.5 mm.
std::string length_text(double metres);

/// A paragraph in lines of at most 118 characters.
std::string wrapped(const std::string& text);

}  // namespace clearway::bench
