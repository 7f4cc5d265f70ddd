#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_calibrate(CLI::App& app, Console& console) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command =
      add_command(app, "calibrate",
                  "measures what a setup needs, with its uncertainty, or refuses with the reason", console);
  command
      ->add_option(
          "what", options->what,
          "camera: focal length, centre, distortion; board: sizes and places of its tags; probe: the "
          "ball's centre, from turning the probe about it; base: where the robot stands, by a board on its "
          "tip; hand-eye: the same and the camera's place, by a camera on its tip")
      ->required()
      ->check(CLI::IsMember({"camera", "board", "probe", "base", "hand-eye"}))
      ->type_name("camera|board|probe|base|hand-eye");
  add_source(*command, options->source, options->camera_seconds, "source",
             "a recording with images; see replay");
  command
      ->add_option("--setup,--board", options->setup,
                   "the boards, as `tags print` writes them; for all but camera also the camera, "
                   "for base and hand-eye also the robot with its joints")
      ->required()
      ->type_name("SETUP.yaml");
  command->add_option("--body", options->body, "name of the board; default: the one that is seen most")
      ->type_name("NAME");
  command
      ->add_option("--sensor", options->sensor,
                   "hand-eye: the sensor of the setup, on `link: tip`, that the camera is")
      ->type_name("NAME");
  command
      ->add_option("--out", options->out,
                   "write a copy of the setup with what was measured; default: print the blocks")
      ->check(file_name)
      ->type_name("FILE.yaml");
  command
      ->add_option("--threads", options->threads,
                   "for searching images; the result does not depend on it; default: all, at most 8")
      ->check(number("a whole number from 1 to 64", 1, 64))
      ->type_name("N");
  return [options](Console& c) { return run_calibrate(*options, c); };
}

}  // namespace clearway
