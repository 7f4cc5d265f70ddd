#pragma once

#include <functional>
#include <map>
#include <string>

namespace clearway {

/// Flags of the command line, and what is called so elsewhere.
using FlagNames = std::map<std::string, std::string, std::less<>>;

/// A sentence with flags replaced by these names: "--group" becomes "group", "--fix JOINT=VALUE" becomes
/// "fixed={'JOINT': VALUE}". Words that are no such flag stay, as does what is part of a longer word: a
/// file's name.
std::string with_names(const std::string& sentence, const FlagNames& names);

/// The same with the keys that files have for flags, as events and setups do: "--policy" becomes "policies".
std::string with_keys(const std::string& sentence);

}  // namespace clearway
