#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/calibrate/calibrations.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "datasets/yaml/moved_files.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Nothing that is read is overwritten.
void require_output(const CalibrateOptions& options, const std::filesystem::path& setup) {
  require_apart({{"--out", options.out}}, {{"SOURCE", options.source}, {"--setup", setup}});
  if (!options.out.empty()) require_writable(options.out);
}

/// The setup's text with the blocks in it, for the file that it will be; it reads back, or this is thrown.
std::string merged(const std::filesystem::path& file, const std::filesystem::path& out,
                   const CalibrationReport& report) {
  const auto folder = [](const std::filesystem::path& of) {
    return of.has_parent_path() ? of.parent_path() : std::filesystem::path(".");
  };
  std::string text = with_files_from(read_text(file, "setup"), folder(file), folder(out));
  for (const std::string& block : report.blocks) text = with_block(text, block);
  parse_setup(text, out.string());
  return text;
}

void print_json(const CalibrationReport& report, const CalibrateOptions& options, Console& console) {
  nlohmann::ordered_json json{{"what", options.what}, {"accepted", report.refusal.empty()}};
  if (!report.refusal.empty()) json["reason"] = report.refusal;
  for (const auto& [name, value] : report.figures) json[name] = value;
  std::string yaml;
  for (const std::string& block : report.blocks) yaml += block;
  json["setup"] = yaml;
  console.out() << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

CalibrationReport report_of(const CalibrateOptions& options, const Setup& setup,
                            const SearchedImages& images) {
  if (options.what == "camera") return report_camera(options, setup, images);
  if (options.what == "board") return report_board(options, setup, images);
  if (options.what == "probe") return report_probe(options, setup, images);
  if (options.what == "base") return report_base(options, setup, images);
  return report_hand_eye(options, setup, images);
}

}  // namespace

int run_calibrate(const CalibrateOptions& options, Console& console) {
  if (!options.lens.empty() && options.what != "camera")
    throw std::invalid_argument("--lens is of `calibrate camera`; the lens that `calibrate " + options.what +
                                "` sees through stands in the setup");
  const std::filesystem::path file = shipped_file("setups", options.setup);
  require_output(options, file);
  Setup setup = load_setup(file);
  setup.source.camera_seconds = options.camera_seconds;
  if (setup.boards.empty())
    throw std::invalid_argument("setup " + quote_path(file.string()) +
                                ": expected `boards` whose tags are to be seen (see clearway tags print)");
  if (!options.out.empty())
    merged(file, options.out, {});  // what cannot be written is refused before the work
  const SearchedImages images = search_images(options.source, setup, options.threads, console);
  if (images.images.empty() && images.damage) {
    console.warn("clearway: " + *images.damage);
    return exit_damaged;
  }
  const CalibrationReport report = report_of(options, setup, images);
  const bool is_good = report.refusal.empty();
  if (is_good && !options.out.empty()) save_file(options.out, merged(file, options.out, report));
  if (console.json) {
    print_json(report, options, console);
  } else {
    print_rows(console.out(), report.rows);
    if (is_good && options.out.empty()) {
      console.out() << '\n';
      for (const std::string& block : report.blocks) console.out() << block;
      console.log(report.next);
    } else if (is_good) {
      console.log("The setup with what was measured: " + quote_path(options.out.string()));
    }
  }
  if (!is_good) console.warn("clearway: calibrate " + options.what + ": " + report.refusal);
  if (images.damage) {
    console.warn("clearway: " + *images.damage);
    return exit_damaged;
  }
  return is_good ? exit_done : exit_no;
}

}  // namespace clearway
