#include "tests/mutation/operators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <string_view>

#include "tests/mutation/code_text.hpp"

namespace clearway::mutation {
namespace {

struct Swap {
  const char *kind, *was, *is;
};

/// Between two operands: spaces on both sides, as clang-format sets them; brackets of templates have none.
constexpr Swap infix[] = {
    {"boundary", "<", "<="},  {"boundary", "<=", "<"},  {"boundary", ">", ">="}, {"boundary", ">=", ">"},
    {"relation", "<", ">="},  {"relation", "<=", ">"},  {"relation", ">", "<="}, {"relation", ">=", "<"},
    {"relation", "==", "!="}, {"relation", "!=", "=="}, {"logic", "&&", "||"},   {"logic", "||", "&&"},
    {"sign", "+", "-"},       {"sign", "-", "+"},       {"sign", "+=", "-="},    {"sign", "-=", "+="},
    {"product", "*", "/"},    {"product", "/", "*"},    {"logic", "|=", "&="},   {"logic", "&=", "|="}};

constexpr Swap words[] = {{"extremum", "std::min(", "std::max("},
                          {"extremum", "std::max(", "std::min("},
                          {"extremum", "cwiseMin(", "cwiseMax("},
                          {"extremum", "cwiseMax(", "cwiseMin("},
                          {"extremum", "minCoeff(", "maxCoeff("},
                          {"extremum", "maxCoeff(", "minCoeff("},
                          {"extremum", "std::floor(", "std::ceil("},
                          {"extremum", "std::ceil(", "std::floor("},
                          {"extremum", ".floor()", ".ceil()"},
                          {"logic", "std::all_of(", "std::any_of("},
                          {"logic", "std::any_of(", "std::all_of("},
                          {"logic", ".all()", ".any()"},
                          {"logic", ".any()", ".all()"},
                          {"absolute", "std::abs(", "("},
                          {"absolute", ".cwiseAbs()", ""},
                          {"absolute", ".abs()", ""}};

bool is_space(char c) { return c == ' ' || c == '\n'; }
bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

class Finder {
 public:
  explicit Finder(const std::string& source) : source_(source), code_(code_only(source)) {}

  std::vector<Fault> run() {
    for (const Swap& swap : infix) find(swap, true);
    for (const Swap& swap : words) find(swap, false);
    dropped_negations();
    dropped_factors();
    numbers();
    lines();
    each(" \\* \\(1\\.0 [-+] \\d+(\\.\\d+)?e-(0?[7-9]|\\d\\d)\\)",
         [&](const std::smatch& m) {  // for rounding
           const auto at = static_cast<std::size_t>(m.position()),
                      end = at + static_cast<std::size_t>(m.length());
           std::erase_if(found_, [&](const Fault& fault) { return fault.at >= at && fault.at < end; });
         });
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Fault& a, const Fault& b) { return a.at < b.at; });
    return std::move(found_);
  }

 private:
  void add(const char* kind, std::size_t at, std::size_t length, const std::string& is) {
    found_.push_back({kind, at, length, is});
  }

  void find(const Swap& swap, bool is_infix) {
    const std::string was = swap.was;
    for (std::size_t at = code_.find(was); at != std::string::npos; at = code_.find(was, at + 1)) {
      if (at == 0 || at + was.size() >= code_.size()) continue;
      if (is_infix && !(is_space(code_[at - 1]) && is_space(code_[at + was.size()]))) continue;
      if (swap.kind == std::string_view("sign") && is_beside_text(at, was.size())) continue;
      add(swap.kind, at, was.size(), swap.is);
    }
  }

  /// Text in quotes is joined by + alone: what is made of it does not compile.
  bool is_beside_text(std::size_t at, std::size_t length) const {
    const std::size_t before = source_.find_last_not_of(" \n", at - 1),
                      behind = source_.find_first_not_of(" \n", at + length);
    return (before != std::string::npos && source_[before] == '"') ||
           (behind != std::string::npos && source_[behind] == '"');
  }

  template <typename Visit>
  void each(const char* pattern, const Visit& visit) {
    const std::regex regex(pattern);
    for (std::sregex_iterator it(code_.begin(), code_.end(), regex), end; it != end; ++it) visit(*it);
  }

  void dropped_negations() {
    each("[ (]!(?=[A-Za-z_(])",
         [&](const std::smatch& m) { add("logic", static_cast<std::size_t>(m.position()) + 1, 1, ""); });
  }

  void dropped_factors() {
    each(
        " \\* "
        "(\\d[\\w.]*|[A-Za-z_]\\w*(::\\w+)*((\\.|->)\\w+|\\([^()\n]*\\)|\\[[^\\[\\]\n]*\\])*|\\([^()\n]*\\))",
        [&](const std::smatch& m) {
          add("product", static_cast<std::size_t>(m.position()), static_cast<std::size_t>(m.length()), "");
        });
    each("\\d[\\w.]* \\* ", [&](const std::smatch& m) {
      const auto at = static_cast<std::size_t>(m.position());
      const bool is_exponent = at > 1 && code_[at - 1] == '-' && code_[at - 2] == 'e';
      if (at > 0 && !is_of_word(code_[at - 1]) && code_[at - 1] != '.' && !is_exponent)
        add("product", at, static_cast<std::size_t>(m.length()), "");
    });
  }

  void numbers() {
    each("\\d[\\d']*(\\.\\d*)?([eE][-+]?\\d+)?[fFuUlL]*", [&](const std::smatch& m) {
      const auto at = static_cast<std::size_t>(m.position()), end = at + static_cast<std::size_t>(m.length());
      const char before = at == 0 ? ' ' : code_[at - 1], behind = end < code_.size() ? code_[end] : ' ';
      if (is_of_word(before) || before == '.' || before == '<' || before == '\'' || behind == '>' ||
          is_of_word(behind))
        return;
      number(at, m.str(), m[1].matched || m[2].matched);
    });
  }

  void number(std::size_t at, const std::string& was, bool is_real) {
    std::string digits = was;
    std::erase(digits, '\'');
    const std::size_t suffix = is_real ? digits.find_first_of("fFlL") : digits.find_first_of("fFuUlL");
    const std::string tail = suffix == std::string::npos ? "" : digits.substr(suffix);
    const double value = std::stod(digits);
    if (!is_real) {
      const auto whole = static_cast<long long>(value);
      add("off by one", at, was.size(), std::to_string(whole + 1) + tail);
      if (whole > 0) add("off by one", at, was.size(), std::to_string(whole - 1) + tail);
      return;
    }
    if (value != 0.0 && value < 1e-6) return;
    if (value != 0.0) add("constant", at, was.size(), "0.0" + tail);
    if (value != 0.0) add("constant", at, was.size(), "(0.5 * " + was + ")");
    if (value != 1.0) add("constant", at, was.size(), "1.0" + tail);
  }

  /// Statements of one line. One begins where the code before it ends in ; { } ) or with `else`.
  void lines() {
    char last = ';';
    for (std::size_t begin = 0; begin < code_.size();) {
      const std::size_t end = std::min(code_.find('\n', begin), code_.size());
      const std::size_t first = code_.find_first_not_of(' ', begin);
      if (first < end) {
        const std::size_t behind = code_.find_last_not_of(' ', end - 1) + 1;
        if (std::string(";{})").find(last) != std::string::npos)
          statement(first, code_.substr(first, behind - first));
        last = code_[behind - 1];
      }
      begin = end + 1;
    }
  }

  void statement(std::size_t at, const std::string& text) {
    static const std::regex drops(
        "(continue|break);|[\\w:.>\\[\\]()*-]+ [-+*/|&<>]*= "
        ".*;|[\\w:.>\\[\\]*-]+\\(.*\\);|(\\+\\+|--)[\\w.>-]+;|"
        "(else )?if \\(.*\\) (continue|break|return[^;]*);");
    static const std::regex returns("return (.*);"),
        condition(".*( && | \\|\\| | < | > | <= | >= | == | != |all_of|any_of|is_\\w+\\().*|!.*|true|false");
    if (std::regex_match(text, drops)) add("dropped", at, text.size(), ";");
    std::smatch match;
    const std::size_t begin = text.find("return ");
    if (begin == std::string::npos || (begin > 0 && text.compare(0, 2, "if") != 0)) return;
    const std::string tail = text.substr(begin);
    if (!std::regex_match(tail, match, returns)) return;
    const std::string value = match[1];
    if (value.find('?') != std::string::npos || !std::regex_match(value, condition)) return;
    for (const char* answer : {"true", "false"})
      if (value != answer) add("answer", at + begin + 7, value.size(), answer);
  }

  const std::string& source_;
  std::string code_;
  std::vector<Fault> found_;
};

}  // namespace

std::string Fault::applied_to(const std::string& source) const {
  return std::string(source).replace(at, length, is);
}

std::vector<Fault> faults_of(const std::string& source) { return Finder(source).run(); }

}  // namespace clearway::mutation
