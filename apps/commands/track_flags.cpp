#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_track(CLI::App& app, Console& console) {
  auto options = std::make_shared<TrackOptions>();
  CLI::App* command = add_command(app, "track",
                                  "estimate poses of tags and boards in images, with their covariance (of "
                                  "the corners' noise alone) and a "
                                  "bound that counts errors of calibration and boards, too",
                                  console);
  add_source(*command, options->source, options->camera_seconds, "source",
             "a recording with images; see replay");
  command
      ->add_option("--setup", options->setup,
                   "camera, boards and probe, by file or name; default: the recording's own")
      ->type_name("SETUP.yaml");
  const auto file = [&](const char* flag, std::filesystem::path& target, const char* description) {
    command->add_option(flag, target, description)->type_name("FILE")->check(file_name);
  };
  file("--csv", options->csv, "write one line per pose; without --csv and --json, to standard output");
  command->remove_option(command->get_option("--json"));
  command
      ->add_option_function<std::string>(
          "--json",
          [options, &console](const std::string& name) {
            options->json = name;
            console.json = name.empty();
          },
          "write one JSON object, to standard output if no FILE is given; apps/OUTPUTS.md has its keys")
      ->expected(0, 1)
      ->trigger_on_parse()
      ->type_name("[FILE]");
  file("--tum-probe", options->tum_probe, "write map_from_probe as TUM text, accepted poses only");
  file("--tum-camera", options->tum_camera, "write map_from_camera as TUM text, accepted poses only");
  command->add_option("--draw", options->draw, "folder for the images with tags, axes and ball drawn in")
      ->type_name("DIR")
      ->check(file_name);
  command
      ->add_option("--threads", options->threads,
                   "threads for tag detection; the poses do not depend on it; default: all cores, at most 8")
      ->check(number("a whole number from 1 to 64", 1, 64))
      ->type_name("N");
  return [options](Console& c) { return run_track(*options, c); };
}

}  // namespace clearway
