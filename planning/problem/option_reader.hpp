#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// Reads a planner's options from text and remembers the values in force. Each reading names one option; an
/// empty or missing text, or "auto" where that is the default, leaves the default.
class OptionReader {
 public:
  /// `owner` is named in messages: "beam: option 'width' ...".
  OptionReader(std::string owner, const std::map<std::string, std::string>& given);

  /// All readings throw std::invalid_argument naming option, value and range when the text does not fit.
  double number(const std::string& name, double initial, double least, double most);
  /// 0 stands for "auto", printed so: the planner derives the value from robot and map.
  double number_or_auto(const std::string& name, double least, double most);
  int integer(const std::string& name, int initial, int least, int most);
  int integer_or_auto(const std::string& name, int least, int most);
  bool flag(const std::string& name, bool initial);
  std::string choice(const std::string& name, const std::string& initial,
                     const std::vector<std::string>& words);
  /// Comma-separated numbers; empty when the option is absent or "auto".
  std::vector<double> numbers_or_auto(const std::string& name, double least, double most);

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
  /// `otherwise`: what may stand in place of the number.
  int parse_whole(const std::string& name, const std::string& text, int least, int most,
                  const std::string& otherwise) const;

  std::string owner_;
  std::map<std::string, std::string> given_, in_force_;
};

}  // namespace clearway
