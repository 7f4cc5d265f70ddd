#pragma once

#include <string>
#include <vector>

namespace clearway::mutation {

/// One small change of a source that a tired programmer might make.
struct Fault {
  std::string kind;  ///< the operator's name
  std::size_t at = 0, length = 0;
  std::string is;  ///< what stands there instead

  std::string applied_to(const std::string& source) const;
};

/// Every fault that the operators make of a source, in the order of its text:
/// - boundary: < and <=, > and >=
/// - relation: a comparison turned into its contrary
/// - logic: && and ||, a ! dropped, all_of and any_of
/// - sign: + and -, += and -=
/// - product: * and /, a factor dropped
/// - extremum: min and max, floor and ceil
/// - constant: a number with a point halved, or 0, or 1. Numbers below 1e-6 stay: they allow for rounding.
/// - off by one: a whole number one more, one less
/// - dropped: a statement, `continue`, `break`, a guard (`if (…) return …;` in one line)
/// - absolute: abs, cwiseAbs dropped
/// - answer: what a condition returns is true, or false
std::vector<Fault> faults_of(const std::string& source);

}  // namespace clearway::mutation
