#include "planning/problem/option_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

namespace {

/// A bound as sentences print it: whole numbers digit by digit, never as 1e+05.
std::string plain(double value) {
  const bool is_whole = value == std::floor(value) && std::abs(value) < 1e15;
  return is_whole ? std::to_string(static_cast<long long>(value)) : to_text(value);
}

std::string range(double least, double most) { return "from " + plain(least) + " to " + plain(most); }

/// What is expected where "auto" is a value, too; so is 0 where it lies in the range.
std::string number_or_auto_in(double least, double most) {
  if (least > 0.0) return "auto or a number " + range(least, most);
  return "auto or a number from 0 (automatic, too) to " + plain(most);
}

}  // namespace

OptionReader::OptionReader(std::string_view owner, const std::map<std::string, std::string>& given)
    : owner_(owner), given_(given) {}

const std::string* OptionReader::text(const std::string& name) const {
  const auto found = given_.find(name);
  return found == given_.end() || found->second.empty() ? nullptr : &found->second;
}

void OptionReader::refuse(const std::string& name, std::string_view text, const std::string& expected) const {
  throw std::invalid_argument(owner_ + ": option '" + name + "' is " + quote(text) + ": expected " +
                              expected);
}

double OptionReader::parse(const std::string& name, std::string_view text, double least, double most,
                           const std::string& expected) const {
  const std::size_t first = text.find_first_not_of(" \t+"), last = text.find_last_not_of(" \t");
  const std::string_view trimmed =
      first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(trimmed.data(), trimmed.data() + trimmed.size(), value);
  const bool is_all_read = error == std::errc() && end == trimmed.data() + trimmed.size();
  if (!is_all_read || !std::isfinite(value) || value < least || value > most) refuse(name, text, expected);
  return value;
}

double OptionReader::given_number(const std::string& name, double initial, double least, double most,
                                  const std::string& expected) const {
  if (const std::string* given = text(name)) return parse(name, *given, least, most, expected);
  if (!(initial >= least && initial <= most)) refuse(name, to_text(initial), expected);  // NaN, too
  return initial;
}

double OptionReader::number(const std::string& name, double initial, double least, double most) {
  const double value = given_number(name, initial, least, most, "a number " + range(least, most));
  in_force_[name] = to_text(value);
  return value;
}

double OptionReader::number_or_auto(const std::string& name, double initial, double least, double most) {
  const std::string* given = text(name);
  const bool is_auto = given ? *given == "auto" : initial == 0.0;
  const double value =
      is_auto ? 0.0 : given_number(name, initial, least, most, number_or_auto_in(least, most));
  in_force_[name] = value == 0.0 ? "auto" : to_text(value);
  return value;
}

int OptionReader::given_whole(const std::string& name, int initial, int least, int most,
                              const std::string& otherwise) const {
  const std::string expected = otherwise + "a whole number " + range(least, most);
  const double value = given_number(name, initial, least, most, expected);
  if (value != std::floor(value)) refuse(name, *text(name), expected);
  return static_cast<int>(value);
}

int OptionReader::integer(const std::string& name, int initial, int least, int most) {
  const int value = given_whole(name, initial, least, most, "");
  in_force_[name] = std::to_string(value);
  return value;
}

int OptionReader::integer_or_auto(const std::string& name, int initial, int least, int most) {
  const std::string* given = text(name);
  const bool is_auto = given ? *given == "auto" : initial == 0;
  const int value = is_auto ? 0 : given_whole(name, initial, least, most, "auto or ");
  in_force_[name] = is_auto ? "auto" : std::to_string(value);
  return value;
}

bool OptionReader::flag(const std::string& name, bool initial) {
  const std::string* given = text(name);
  bool value = initial;
  if (given) {
    const bool is_true = *given == "true" || *given == "on" || *given == "yes" || *given == "1";
    const bool is_false = *given == "false" || *given == "off" || *given == "no" || *given == "0";
    if (!is_true && !is_false) refuse(name, *given, "true or false");
    value = is_true;
  }
  in_force_[name] = value ? "true" : "false";
  return value;
}

std::string OptionReader::choice(const std::string& name, const std::string& initial,
                                 const std::vector<std::string>& words) {
  const std::string* given = text(name);
  const std::string value = given ? *given : initial;
  if (std::find(words.begin(), words.end(), value) == words.end()) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : " or ") + word;
    refuse(name, value, list);
  }
  return in_force_[name] = value;
}

std::vector<double> OptionReader::numbers_or_auto(const std::string& name, const std::vector<double>& initial,
                                                  double least, double most) {
  const std::string* given = text(name);
  const std::string all = given ? *given : to_text(initial);
  std::vector<double> values;
  if (!all.empty() && all != "auto") {
    const std::string expected = "auto or numbers " + range(least, most) + ", separated by commas";
    std::string_view rest = all;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
      comma = rest.find(',');
      values.push_back(parse(name, rest.substr(0, comma), least, most, expected));
      if (comma != std::string_view::npos) rest.remove_prefix(comma + 1);
    }
  }
  in_force_[name] = values.empty() ? "auto" : to_text(values);
  return values;
}

void OptionReader::refuse_unknown() const {
  std::vector<std::string> known;
  for (const auto& [name, value] : in_force_) known.push_back(name);
  for (const auto& [name, value] : given_) {
    if (in_force_.contains(name)) continue;
    throw std::invalid_argument(owner_ + ": unknown option " + quote(name) + ": " + suggestion(name, known));
  }
}

}  // namespace clearway
