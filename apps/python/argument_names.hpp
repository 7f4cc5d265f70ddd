#pragma once

#include <string>

namespace clearway {

/// A sentence of the libraries with flags of the command line replaced by the arguments of the module that
/// do the same: "--fix JOINT=VALUE" becomes "fixed={'JOINT': VALUE}", "--group" becomes "group". Words that
/// are no such flag stay, as does what is part of a longer word: a file's name.
std::string with_argument_names(const std::string& sentence);

}  // namespace clearway
