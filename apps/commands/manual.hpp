#pragma once

#include <string>

namespace CLI {
class App;
}

namespace clearway {

/// The page of the manual, clearway(1), in roff (man-pages(7)): all commands with their flags, as --help has
/// them.
std::string manual_page(const CLI::App& app);

/// A script that completes commands, flags, values of which there are few or that have names, and files.
/// @param shell "bash" or "zsh"
std::string completion(const CLI::App& app, const std::string& shell);

}  // namespace clearway
