#include "planning/option_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "planning/nearest_name.hpp"

namespace clearway {

std::string to_text(double value) {
  char buffer[40];
  return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

std::string to_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + to_text(value);
  return text;
}

std::string short_text(double value) {
  char buffer[40];
  return std::string(buffer,
                     std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 4).ptr);
}

OptionReader::OptionReader(std::string owner, const std::map<std::string, std::string>& given)
    : owner_(std::move(owner)), given_(given) {}

const std::string* OptionReader::text(const std::string& name) const {
  const auto found = given_.find(name);
  return found == given_.end() || found->second.empty() ? nullptr : &found->second;
}

double OptionReader::parse(const std::string& name, std::string_view text, double least, double most) const {
  const std::size_t first = text.find_first_not_of(" \t+"), last = text.find_last_not_of(" \t");
  const std::string_view trimmed =
      first == std::string_view::npos ? std::string_view{} : text.substr(first, last - first + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(trimmed.data(), trimmed.data() + trimmed.size(), value);
  const bool is_whole = error == std::errc() && end == trimmed.data() + trimmed.size();
  if (!is_whole || !std::isfinite(value) || value < least || value > most) {
    throw std::invalid_argument(owner_ + ": option '" + name + "' is '" + std::string(text) +
                                "': expected a number from " + to_text(least) + " to " + to_text(most));
  }
  return value;
}

double OptionReader::number(const std::string& name, double initial, double least, double most) {
  const std::string* given = text(name);
  const double value = given ? parse(name, *given, least, most) : initial;
  in_force_[name] = to_text(value);
  return value;
}

double OptionReader::number_or_auto(const std::string& name, double least, double most) {
  const std::string* given = text(name);
  const double value = given && *given != "auto" ? parse(name, *given, least, most) : 0.0;
  in_force_[name] = value == 0.0 ? "auto" : to_text(value);
  return value;
}

int OptionReader::integer(const std::string& name, int initial, int least, int most) {
  const double value = number(name, initial, least, most);
  if (value != std::floor(value)) {
    throw std::invalid_argument(owner_ + ": option '" + name + "' is '" + to_text(value) +
                                "': expected a whole number");
  }
  return static_cast<int>(value);
}

int OptionReader::integer_or_auto(const std::string& name, int least, int most) {
  const std::string* given = text(name);
  if (given && *given != "auto") return integer(name, 0, least, most);
  in_force_[name] = "auto";
  return 0;
}

bool OptionReader::flag(const std::string& name, bool initial) {
  const std::string* given = text(name);
  bool value = initial;
  if (given) {
    const bool is_true = *given == "true" || *given == "on" || *given == "yes" || *given == "1";
    const bool is_false = *given == "false" || *given == "off" || *given == "no" || *given == "0";
    if (!is_true && !is_false) {
      throw std::invalid_argument(owner_ + ": option '" + name + "' is '" + *given +
                                  "': expected true or false");
    }
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
    throw std::invalid_argument(owner_ + ": option '" + name + "' is '" + value + "': expected " + list);
  }
  return in_force_[name] = value;
}

std::vector<double> OptionReader::numbers_or_auto(const std::string& name, double least, double most) {
  std::vector<double> values;
  const std::string* given = text(name);
  if (given && *given != "auto") {
    std::string_view rest = *given;
    for (std::size_t comma = 0; comma != std::string_view::npos;) {
      comma = rest.find(',');
      values.push_back(parse(name, rest.substr(0, comma), least, most));
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
    throw std::invalid_argument(owner_ + ": unknown option '" + name + "'" +
                                (known.empty() ? "" : ": did you mean '" + nearest_name(name, known) + "'?"));
  }
}

}  // namespace clearway
