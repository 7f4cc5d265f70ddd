#include "planning/files/json_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <vector>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using AnyJson = nlohmann::json;

constexpr std::size_t deepest = 64, most_containers = 1'000'000, most_values = 8'000'000;

/// Follows the parser, so that it can say in plain words what should have come next.
class SizeLimit {
 public:
  SizeLimit(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  bool null() { return value(); }
  bool boolean(bool) { return value(); }
  bool number_integer(AnyJson::number_integer_t) { return value(); }
  bool number_unsigned(AnyJson::number_unsigned_t) { return value(); }
  bool number_float(AnyJson::number_float_t, const AnyJson::string_t&) { return value(); }
  bool string(AnyJson::string_t&) { return value(); }
  bool binary(AnyJson::binary_t&) { return value(); }
  bool start_object(std::size_t) { return open(Place::object_start); }
  bool start_array(std::size_t) { return open(Place::array_start); }
  bool key(AnyJson::string_t& key) {
    open_.back() = Place::after_key;
    if (!keys_.back().insert(key).second)
      throw std::invalid_argument(name_ + " has key " + quote(shortened(key)) +
                                  " twice in one object, expected it once");
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool parse_error(std::size_t position, const std::string&, const AnyJson::exception& error) {
    constexpr int number_too_large = 406;
    if (const std::size_t wrong = first_not_utf8(text_); wrong < position) refuse(wrong, "text in UTF-8");
    const std::size_t start = word_start(position);
    refuse(start, error.id == number_too_large ? "a number that is not too large" : expected(before(start)));
  }

 private:
  enum class Place { start, end, object_start, after_key, object_value, array_start, array_value };

  bool value() {
    if (++values_ > most_values) refuse_size("8,000,000 values");
    Place& place = open_.back();
    place = place == Place::start       ? Place::end
            : place == Place::after_key ? Place::object_value
                                        : Place::array_value;
    return true;
  }
  bool open(Place place) {
    value();
    if (++containers_ > most_containers) refuse_size("1,000,000 arrays and objects");
    if (open_.size() > deepest) refuse_size("64 arrays and objects inside each other");
    open_.push_back(place);
    keys_.emplace_back();
    return true;
  }
  bool close() {
    open_.pop_back();
    keys_.pop_back();
    return true;
  }

  /// Where the number, word or text that ends at `position` begins; else the place of the character before
  /// it.
  std::size_t word_start(std::size_t position) const {
    const auto is_word = [&](std::size_t at) {
      const char c = at < text_.size() ? text_[at] : ' ';
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
             c == '+' || c == '-';
    };
    std::size_t start = std::min(position > 0 ? position - 1 : 0, text_.size());
    if (start > 0 && start < text_.size() && text_[start] == '"') {
      const std::size_t opening = text_.rfind('"', start - 1);
      return opening == std::string_view::npos ? start : opening;
    }
    while (start > 0 && is_word(start) && is_word(start - 1)) --start;
    return start;
  }

  /// The last character before `position` that is no blank; 0 when there is none.
  char before(std::size_t position) const {
    const std::size_t last = text_.substr(0, position).find_last_not_of(" \t\r\n");
    return last == std::string_view::npos ? '\0' : text_[last];
  }

  std::string expected(char last) const {
    switch (open_.back()) {
      case Place::start:
        return "a value";
      case Place::after_key:
        return last == ':' ? "a value" : "':' and a value";
      case Place::end:
        return "nothing more";
      case Place::object_start:
        return "a key in quotes, or '}'";
      case Place::object_value:
        return last == ',' ? "a key in quotes" : "',' and a key in quotes, or '}'";
      case Place::array_start:
        return "a value, or ']'";
      case Place::array_value:
        return last == ',' ? "a value" : "',' and a value, or ']'";
    }
    return "a value";
  }

  [[noreturn]] void refuse(std::size_t position, const std::string& expected) const {
    const std::string_view before = text_.substr(0, std::min(position, text_.size()));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t start = before.rfind('\n') + 1;                     // npos + 1 = 0: the first line
    const bool is_one_line = text_.find('\n') == std::string_view::npos;  // perhaps one of many of a stream
    throw std::invalid_argument(name_ + " is not valid JSON at " +
                                (is_one_line ? "" : "line " + std::to_string(line) + ", ") + "column " +
                                std::to_string(before.size() - start + 1) + ": expected " + expected);
  }
  [[noreturn]] void refuse_size(const std::string& most) const {
    throw std::invalid_argument(name_ + " is too large: expected at most " + most);
  }

  std::string_view text_;
  const std::string& name_;
  std::vector<Place> open_{Place::start};
  std::vector<std::set<std::string>> keys_;  ///< of each open object
  std::size_t values_ = 0, containers_ = 0;
};

}  // namespace

void require_json(std::string_view text, const std::string& name) {
  SizeLimit limit(text, name);
  static_cast<void>(AnyJson::sax_parse(text, &limit));
}

}  // namespace clearway
