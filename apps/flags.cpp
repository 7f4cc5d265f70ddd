#include "apps/flags.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <limits>

namespace clearway {

Check number(const std::string& expected, double low, double high) {
  return [=](const std::string& text) {
    double value = 0.0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good =
        error == std::errc() && stop == text.data() + text.size() && value >= low && value <= high;
    return good ? std::string() : "expected " + expected + ", got '" + text + "'";
  };
}

Check positive() {
  return number("a positive number up to 1000000000", std::numeric_limits<double>::min(), 1e9);
}

std::string whole_number(const std::string& text) {
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool good = error == std::errc() && stop == text.data() + text.size();
  return good ? "" : "expected a whole number from 0 to 18446744073709551615, got '" + text + "'";
}

std::string file_name(const std::string& text) { return text.empty() ? "expected a file name, got ''" : ""; }

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description,
                      Console& console) {
  CLI::App* command = app.add_subcommand(name, description);
  command->add_flag("--quiet", console.quiet, "no log, no progress; results and warnings still appear");
  command->add_flag("--json", console.json, "print one JSON object on stdout and nothing else there");
  command->get_formatter()->column_width(36);
  return command;
}

}  // namespace clearway
