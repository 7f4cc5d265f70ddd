#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Options of a planner: text given over values of its struct, checked alike, and printed. Each reading names
/// one option and passes the struct's value, which an empty or missing text leaves.
class OptionReader {
 public:
  /// `owner` is named in messages: "beam: option 'width' ...".
  explicit OptionReader(std::string_view owner, const std::map<std::string, std::string>& given = {});

  /// All readings throw std::invalid_argument naming option, value and range when the text, or the struct's
  /// value where there is none, does not fit.
  double number(const std::string& name, double initial, double least, double most);
  /// 0 stands for "auto", printed so: the planner derives the value from robot and map.
  double number_or_auto(const std::string& name, double initial, double least, double most);
  int integer(const std::string& name, int initial, int least, int most);
  /// 0 in the struct stands for "auto", printed so.
  int integer_or_auto(const std::string& name, int initial, int least, int most);
  bool flag(const std::string& name, bool initial);
  std::string choice(const std::string& name, const std::string& initial,
                     const std::vector<std::string>& words);
  /// Comma-separated numbers; none stand for "auto", printed so.
  std::vector<double> numbers_or_auto(const std::string& name, const std::vector<double>& initial,
                                      double least, double most);

  /// @throws std::invalid_argument for an option that was given but never read, naming the nearest known.
  void refuse_unknown() const;

  /// Every option that was read, with the value in force.
  const std::map<std::string, std::string>& in_force() const { return in_force_; }

 private:
  const std::string* text(const std::string& name) const;
  /// @throws std::invalid_argument: what the option is and what it should be.
  [[noreturn]] void refuse(const std::string& name, std::string_view text, const std::string& expected) const;
  double parse(const std::string& name, std::string_view text, double least, double most,
               const std::string& expected) const;
  /// The number given, else `initial`, both in the range.
  double given_number(const std::string& name, double initial, double least, double most,
                      const std::string& expected) const;
  /// The same of whole numbers. `otherwise`: what may stand in place of the number.
  int given_whole(const std::string& name, int initial, int least, int most,
                  const std::string& otherwise) const;

  std::string owner_;
  std::map<std::string, std::string> given_, in_force_;
};

// Beside each struct of options lies `Options read_options(OptionReader&, Options initial)`: names, ranges
// and text forms, in one place for both ways in.

/// The struct that this text describes. @throws std::invalid_argument as OptionReader, and for unknown names.
template <typename Options>
Options options_of_text(std::string_view planner, const std::map<std::string, std::string>& text) {
  OptionReader reader(planner, text);
  const Options options = read_options(reader, Options());
  reader.refuse_unknown();
  return options;
}

/// The text form of these options, which reads back to the same. @throws std::invalid_argument naming the
/// option that is out of range.
template <typename Options>
std::map<std::string, std::string> text_of_options(std::string_view planner, const Options& options) {
  OptionReader reader(planner);
  read_options(reader, options);
  return reader.in_force();
}

}  // namespace clearway
