#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_calibrate(CLI::App& app, Console& console) {
  auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = add_command(
      app, "calibrate",
      "calibrate camera, boards, probe or robot, with uncertainty; or refuse with the reason", console);
  command
      ->add_option("what", options->what,
                   "camera: intrinsics and distortion; board: sizes and poses of its tags; probe: center of "
                   "the ball, by pivoting the probe about it; base: pose of the robot's base, from a board "
                   "on its tip; hand-eye: the same and the camera's pose, from a camera on its tip")
      ->required()
      ->check(one_of({"camera", "board", "probe", "base", "hand-eye"}))
      ->type_name("camera|board|probe|base|hand-eye");
  add_source(*command, options->source, options->camera_seconds, "source",
             "a recording with images; see replay");
  command
      ->add_option("--setup,--board", options->setup,
                   "the boards, as `tags print` writes them; for all but camera also the camera, "
                   "for base and hand-eye also the robot with its joints")
      ->required()
      ->type_name("SETUP.yaml");
  command->add_option("--body", options->body, "name of the board; default: the one seen most often")
      ->type_name("NAME");
  command
      ->add_option(
          "--lens", options->lens,
          "camera: plumb_bob (k1, k2, p1, p2, k3; the default), rational (k4, k5, k6 too, of a wide lens; "
          "refused where a simpler one does as well) or fisheye (k1 to k4 of cv::fisheye)")
      ->check(one_of({"plumb_bob", "rational", "fisheye"}))
      ->type_name("plumb_bob|rational|fisheye");
  command
      ->add_option("--sensor", options->sensor,
                   "hand-eye: the setup's sensor on `link: tip` that stands for the camera")
      ->type_name("NAME");
  command
      ->add_option("--out", options->out,
                   "write a copy of the setup with the results; default: print the YAML blocks")
      ->check(file_name)
      ->type_name("FILE.yaml");
  command
      ->add_option(
          "--threads", options->threads,
          "threads for tag detection; the result does not depend on it; default: all cores, at most 8")
      ->check(number("a whole number from 1 to 64", 1, 64))
      ->type_name("N");
  return [options](Console& c) { return run_calibrate(*options, c); };
}

}  // namespace clearway
