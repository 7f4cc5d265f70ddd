#include "datasets/yaml/yaml_fields.hpp"

#include <yaml-cpp/binary.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/yaml/moved_files.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Whole numbers are printed digit by digit, never as 1e+06.
std::string shown_number(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  if (value == std::round(value) && std::abs(value) < 1e15) out << std::fixed << std::setprecision(0);
  out << value;
  return out.str();
}

std::string expectation(Bounds bounds, const std::string& kind = "number") {
  if (std::isinf(bounds.low) && std::isinf(bounds.high)) return "a finite " + kind;
  const std::string high = shown_number(bounds.high);
  if (bounds.low == tiny) return "a positive " + kind + " up to " + high;
  return "a " + kind + " from " + shown_number(bounds.low) + " to " + high;
}

/// A finite number that is the whole text of a scalar.
std::optional<double> parsed_number(const YAML::Node& node) {
  if (!node.IsScalar()) return std::nullopt;
  const std::string& text = node.Scalar();
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const bool good = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return good ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string shown_node(const YAML::Node& node) {
  if (node.IsScalar() && node.Scalar() == "...")
    return "'...', by which ros2 topic echo shortens lists unless it is called with --full-length";
  if (node.IsScalar()) return quote(node.Scalar());
  return node.IsSequence() ? "a list" : node.IsMap() ? "a map" : "nothing";
}

YamlFields::YamlFields(const std::string& text, const std::string& name, const YamlBounds& bounds)
    : name_(name) {
  require_yaml(text, name, bounds);
  try {
    node_ = std::make_shared<YAML::Node>(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(name + ", line " + std::to_string(error.mark.line + 1) + ": not valid YAML.");
  }
  check_map();
}

YamlFields::YamlFields(const YAML::Node& node, const std::string& name, const std::string& path)
    : node_(std::make_shared<YAML::Node>(node)), name_(name), path_(path) {
  check_map();
}

void YamlFields::check_map() const {
  if (node_->IsNull()) return;
  // Of a file that is none of ours, such as one that a scene names by mistake, nothing is shown.
  const bool is_file = path_.empty();
  if (!node_->IsMap())
    fail("", "expected a map of keys and values" + (is_file ? "" : ", got " + shown_node(*node_)));
  std::set<std::string> seen;
  for (const auto& entry : *node_) {
    if (!entry.first.IsScalar()) fail("", "expected plain words as keys");
    if (!seen.insert(entry.first.Scalar()).second) fail(entry.first.Scalar(), "this key is given twice");
  }
}

void YamlFields::fail(const std::string& key, const std::string& what) const {
  YAML::Mark mark = node_->Mark();
  if (node_->IsMap() && !key.empty())
    for (const auto& entry : *node_)
      if (entry.first.IsScalar() && entry.first.Scalar() == key) mark = entry.second.Mark();
  const std::string line = mark.is_null() ? "" : ", line " + std::to_string(mark.line + 1);
  const std::string plain_key = key.empty() ? "" : shortened(key);
  const std::string where = path_ + (path_.empty() || key.empty() ? "" : ".") + plain_key;
  throw std::invalid_argument(name_ + line + (where.empty() ? "" : ", " + where) + ": " + ended(what));
}

YAML::Node YamlFields::find(const std::string& key) const {
  asked_.insert(key);
  if (node_->IsMap())
    for (const auto& entry : *node_)
      if (entry.first.Scalar() == key) return entry.second;
  return YAML::Node(YAML::NodeType::Undefined);
}

namespace {

/// The same letters, or of a long name one more or less: those that differ by a letter may both be keys.
bool is_slip_of(const std::string& there, const std::string& key) {
  const auto letters = [](const std::string& name) {
    std::string all;
    for (const char c : name)
      if (std::isalnum(static_cast<unsigned char>(c)) != 0)
        all += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return all;
  };
  return letters(there) == letters(key) ||
         (key.size() >= 4 && there.size() != key.size() && edit_distance(there, key) == 1);
}

}  // namespace

/// ", is 'f_x' meant to be it?", where such a key is there that nobody asked for; else empty.
std::string YamlFields::meant_by(const std::string& key) const {
  if (node_->IsMap())
    for (const auto& entry : *node_)
      if (const std::string& there = entry.first.Scalar(); !asked_.contains(there) && is_slip_of(there, key))
        return ", is " + quote(there) + " meant to be it?";
  return "";
}

YAML::Node YamlFields::required(const std::string& key) const {
  YAML::Node node = find(key);
  if (!node.IsDefined() || node.IsNull()) fail(key, "this key is missing" + meant_by(key));
  return node;
}

bool YamlFields::is_list(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && node.IsSequence();
}

bool YamlFields::is_map(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && node.IsMap();
}

bool YamlFields::is_empty(const std::string& key) const {
  const YAML::Node node = find(key);
  return !node.IsDefined() || node.size() == 0;
}

bool YamlFields::is_word(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && node.IsScalar() && !parsed_number(node);
}

std::vector<std::string> YamlFields::words_among(const std::string& key) const {
  std::vector<std::string> words;
  const std::string given = degrees_key(key);
  if (!is_list(given)) return words;
  for (const auto& item : find(given)) {
    const bool is_word = item.IsScalar() && !parsed_number(item);
    words.push_back(is_word ? checked_text(item.Scalar(), given, 80) : "");
  }
  return words;
}

bool YamlFields::has(const std::string& key) const {
  const YAML::Node node = find(key);
  return node.IsDefined() && !node.IsNull();
}

bool YamlFields::names(const std::string& key) const { return find(key).IsDefined(); }

double YamlFields::number_of(const YAML::Node& node, const std::string& key, Bounds bounds) const {
  const std::optional<double> value = parsed_number(node);
  if (!value || *value < bounds.low || *value > bounds.high)
    fail(key, "expected " + expectation(bounds) + ", got " + shown_node(node));
  return *value;
}

double YamlFields::number(const std::string& key, Bounds bounds) const {
  return number_of(required(key), key, bounds);
}

double YamlFields::number(const std::string& key, Bounds bounds, double otherwise) const {
  return has(key) ? number(key, bounds) : otherwise;
}

std::optional<double> YamlFields::optional_number(const std::string& key, Bounds bounds) const {
  if (!has(key)) return std::nullopt;
  return number(key, bounds);
}

int YamlFields::integer(const std::string& key, Bounds bounds) const {
  const YAML::Node node = required(key);
  const std::optional<double> value = parsed_number(node);
  if (!value || *value != std::round(*value) || *value < bounds.low || *value > bounds.high)
    fail(key, "expected " + expectation(bounds, "whole number") + ", got " + shown_node(node));
  return static_cast<int>(*value);
}

int YamlFields::integer(const std::string& key, Bounds bounds, int otherwise) const {
  return has(key) ? integer(key, bounds) : otherwise;
}

std::uint64_t YamlFields::seed(const std::string& key, std::uint64_t otherwise) const {
  if (!has(key)) return otherwise;
  const YAML::Node node = find(key);
  const std::string text = node.IsScalar() ? node.Scalar() : "";
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    fail(key, "expected a whole number from 0 to 18446744073709551615, got " + shown_node(node));
  return value;
}

bool YamlFields::boolean(const std::string& key) const {
  const YAML::Node node = required(key);
  const std::string word = node.IsScalar() ? node.Scalar() : "";
  for (const char* yes : {"true", "True", "TRUE"})  // the words of YAML's core schema; Python writes True
    if (word == yes) return true;
  for (const char* no : {"false", "False", "FALSE"})
    if (word == no) return false;
  fail(key, "expected true or false, got " + shown_node(node));
}

std::optional<int> YamlFields::control_character(const std::string& key) const {
  const YAML::Node node = find(key);
  if (!node.IsDefined() || !node.IsScalar()) return std::nullopt;
  const bool is_binary = node.Tag() == "tag:yaml.org,2002:binary";
  const std::vector<unsigned char> decoded =
      is_binary ? YAML::DecodeBase64(node.Scalar()) : std::vector<unsigned char>();
  if ((is_binary ? decoded.size() : node.Scalar().size()) != 1) return std::nullopt;
  const int number = is_binary ? decoded[0] : static_cast<unsigned char>(node.Scalar().front());
  return number < 0x20 ? std::optional(number) : std::nullopt;
}

std::string YamlFields::text(const std::string& key) const {
  const YAML::Node node = required(key);
  if (!node.IsScalar() || node.Scalar().empty())
    fail(key, "expected a word or text, got " + shown_node(node));
  return checked_text(node.Scalar(), key, 80);
}

std::string YamlFields::checked_text(const std::string& text, const std::string& key, size_t longest) const {
  if (text.size() > longest)
    fail(key, "expected at most " + std::to_string(longest) + " characters, got " + quote(text));
  if (plain(text) != text)
    fail(key, std::string("expected ") +
                  (first_not_utf8(text) == std::string::npos ? "no control characters" : "UTF-8") + ", got " +
                  quote(text));
  return text;
}

std::string YamlFields::file(const std::string& key) const {
  const YAML::Node node = required(key);
  if (!node.IsScalar() || node.Scalar().empty()) fail(key, "expected a file, got " + shown_node(node));
  return checked_text(node.Scalar(), key, 255);
}

std::string YamlFields::robot(const std::string& key, const std::filesystem::path& folder) const {
  const std::filesystem::path given = file(key);
  return is_description_file(given.string()) ? (folder / given).string() : given.string();
}

std::string YamlFields::prose(const std::string& key, const std::string& otherwise) const {
  if (!has(key)) return otherwise;
  const YAML::Node node = required(key);
  if (!node.IsScalar()) fail(key, "expected a text, got " + shown_node(node));
  std::string words = node.Scalar();
  std::replace(words.begin(), words.end(), '\n', ' ');
  std::replace(words.begin(), words.end(), '\t', ' ');
  checked_text(words, key, 10'000);
  return node.Scalar();
}

std::string YamlFields::text(const std::string& key, const std::string& otherwise) const {
  return has(key) ? text(key) : otherwise;
}

std::string YamlFields::text_or_numbers(const std::string& key) const {
  const YAML::Node node = required(key);
  if (!node.IsSequence()) return text(key);
  std::string result;
  for (const auto& item : node) {
    number_of(item, key, {});
    result += (result.empty() ? "" : ", ") + item.Scalar();
  }
  if (result.empty()) fail(key, "expected a word, a number or a list of numbers, got an empty list");
  return result;
}

std::vector<std::string> YamlFields::texts_of(const YAML::Node& node, const std::string& key) const {
  if (!node.IsSequence()) fail(key, "expected a list of words, got " + shown_node(node));
  std::vector<std::string> result;
  for (const auto& item : node) {
    if (!item.IsScalar()) fail(key, "expected a list of words, got " + shown_node(item) + " in it");
    result.push_back(checked_text(item.Scalar(), key, 80));
  }
  return result;
}

std::vector<std::string> YamlFields::texts(const std::string& key) const {
  return has(key) ? texts_of(find(key), key) : std::vector<std::string>();
}

std::vector<std::string> YamlFields::full_texts(const std::string& key) const {
  std::vector<std::string> result = texts(key);
  if (std::find(result.begin(), result.end(), "") != result.end())
    fail(key, "expected a list of words, got an empty one in it");
  return result;
}

std::vector<std::vector<std::string>> YamlFields::lists_of_texts(const std::string& key,
                                                                 const std::string& name) const {
  std::vector<std::vector<std::string>> result;
  if (!has(key)) return result;
  const YAML::Node node = find(key);
  if (!node.IsSequence()) fail(key, "expected a list of lists of words, got " + shown_node(node));
  for (const auto& item : node) {
    const YAML::Node list = item.IsMap() ? item[name] : item;
    if (!list.IsDefined()) fail(key, "expected " + quote(name) + " in each of its maps");
    result.push_back(texts_of(list, key));
  }
  return result;
}

std::vector<double> YamlFields::numbers_of(const YAML::Node& node, const std::string& key,
                                           Bounds bounds) const {
  if (!node.IsSequence()) fail(key, "expected a list of numbers, got " + shown_node(node));
  std::vector<double> result;
  for (const auto& item : node) result.push_back(number_of(item, key, bounds));
  return result;
}

std::vector<double> YamlFields::numbers(const std::string& key, Bounds bounds) const {
  return numbers_of(required(key), key, bounds);
}

std::vector<double> YamlFields::numbers(const std::string& key, Bounds bounds, size_t size) const {
  auto result = numbers(key, bounds);
  if (result.size() != size)
    fail(key, "expected " + counted(size, "number") + ", got " + std::to_string(result.size()));
  return result;
}

std::vector<double> YamlFields::flat_numbers(const std::string& key, Bounds bounds) const {
  const YAML::Node node = required(key);
  if (!node.IsSequence() || node.size() == 0 || !node.begin()->IsSequence()) return numbers(key, bounds);
  std::vector<double> all;
  for (const auto& item : node) {
    const std::vector<double> row = numbers_of(item, key, bounds);
    if (node.size() > 1 && row.size() != 1) fail(key, "expected one row of numbers, got several");
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

std::vector<std::vector<double>> YamlFields::lists_of_numbers(const std::string& key, Bounds bounds,
                                                              size_t size) const {
  std::vector<std::vector<double>> lists = lists_of_numbers(key, bounds);
  for (const std::vector<double>& list : lists)
    if (list.size() != size)
      fail(key, "expected " + counted(size, "number") + " in each of its lists, got " +
                    std::to_string(list.size()));
  return lists;
}

std::vector<std::vector<double>> YamlFields::lists_of_numbers(const std::string& key, Bounds bounds) const {
  const YAML::Node node = required(key);
  if (!node.IsSequence()) fail(key, "expected a list of lists of numbers, got " + shown_node(node));
  std::vector<std::vector<double>> result;
  for (const auto& item : node) result.push_back(numbers_of(item, key, bounds));
  return result;
}

std::vector<double> YamlFields::row_of(const YAML::Node& node, const std::string& key, Bounds bounds,
                                       const std::vector<std::string>& names) const {
  if (!node.IsMap()) return numbers_of(node, key, bounds);
  std::vector<double> row;
  for (const std::string& name : names) {
    const YAML::Node value = node[name];
    if (!value.IsDefined()) fail(key, "expected " + quote(name) + " in each of its maps");
    const std::vector<double> more = value.IsSequence() ? numbers_of(value, key, bounds)
                                                        : std::vector<double>{number_of(value, key, bounds)};
    row.insert(row.end(), more.begin(), more.end());
  }
  return row;
}

std::vector<std::vector<double>> YamlFields::rows(const std::string& key, Bounds bounds, size_t size,
                                                  const std::vector<std::string>& names) const {
  const YAML::Node node = required(key);
  if (!node.IsSequence()) fail(key, "expected a list of rows of numbers, got " + shown_node(node));
  std::vector<std::vector<double>> result;
  if (node.size() > 0 && node.begin()->IsScalar()) {
    const std::vector<double> all = numbers_of(node, key, bounds);
    if (all.size() % size != 0)
      fail(key, "expected " + counted(size, "number") + " for each row, got " + std::to_string(all.size()));
    for (auto at = all.begin(); at != all.end(); at += static_cast<std::ptrdiff_t>(size))
      result.emplace_back(at, at + static_cast<std::ptrdiff_t>(size));
    return result;
  }
  for (const auto& item : node) {
    result.push_back(row_of(item, key, bounds, names));
    if (result.back().size() != size)
      fail(key, "expected " + counted(size, "number") + " in each of its rows, got " +
                    std::to_string(result.back().size()));
  }
  return result;
}

Eigen::Vector3d YamlFields::vector(const std::string& key) const {
  return Eigen::Vector3d(numbers(key, within_reach, 3).data());
}

YamlFields YamlFields::map(const std::string& key) const {
  return YamlFields(required(key), name_, path_ + (path_.empty() ? "" : ".") + shortened(key));
}

std::vector<YamlFields> YamlFields::list_of_maps(const std::string& key) const {
  std::vector<YamlFields> result;
  if (!has(key)) return result;
  const YAML::Node node = find(key);
  if (!node.IsSequence()) fail(key, "expected a list, got " + shown_node(node));
  const std::string path = path_ + (path_.empty() ? "" : ".") + shortened(key);
  for (const auto& item : node)
    result.push_back(YamlFields(item, name_, path + "[" + std::to_string(result.size()) + "]"));
  return result;
}

std::vector<std::string> YamlFields::keys() const {
  std::vector<std::string> result;
  if (node_->IsMap())
    for (const auto& entry : *node_) result.push_back(entry.first.Scalar());
  asked_.insert(result.begin(), result.end());
  return result;
}

void YamlFields::finish() const {
  if (!node_->IsMap()) return;
  for (const auto& entry : *node_) {
    const std::string key = entry.first.Scalar();
    if (asked_.contains(key)) continue;
    fail(key, "unknown key; " + suggestion(key, {asked_.begin(), asked_.end()}));
  }
}

}  // namespace clearway
