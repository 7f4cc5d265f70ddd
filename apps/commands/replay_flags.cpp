#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {
namespace {

/// What a recording's map is like.
void add_map_flags(CLI::App& command, double& resolution, std::string& integration, int& threads) {
  command.add_option("--resolution", resolution, "edge of a voxel, metres; default: the setup's, else 0.02")
      ->check(number("a number from 0.0001 to 100", 1e-4, 100.0))
      ->type_name("M");
  command
      .add_option("--integration", integration,
                  "how scans free space: safe (no voxel next to a surface), or compatible (with OctoMap); "
                  "default: the setup's, else safe")
      ->check(one_of({"safe", "compatible"}))
      ->type_name("MODE");
  command
      .add_option(
          "--threads", threads,
          "threads for images and scans; the map does not depend on it; default: all cores, at most 8")
      ->check(number("a whole number from 1 to 64", 1, 64))
      ->type_name("N");
}

}  // namespace

Command add_replay(CLI::App& app, Console& console) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = add_command(
      app, "replay", "turn a recording into painted spheres, a fused map, plans and a report page", console);
  add_source(*command, options->recording, options->camera_seconds, "recording",
             "MRPT rawlog; ROS bag (.bag, .mcap, .db3); scan graph of OctoMap; video; .pcd, .ply, .bin, .png "
             "or .jpg: a file, or a "
             "folder of "
             "them; folder of depth pictures");
  command
      ->add_option("--setup", options->setup,
                   "tag boards, probe, robot and queries, by file or name; default: the recording's own")
      ->type_name("SETUP.yaml");
  add_file(*command, "--out", options->out,
           "folder for map.ot, painted.csv, report.json, report.html, plans/", "DIR")
      ->required();
  add_map_flags(*command, options->resolution, options->integration, options->threads);
  add_repeatable(*command, "--planner", options->planners,
                 "use this planner instead of the queries' own; repeatable", "NAME");
  command
      ->add_option(
          "--record", options->record,
          "write poses, scans, spheres, voxels and plans as ROS 2 messages, for Foxglove and rosbag2")
      ->check(file_of_kind(".mcap"))
      ->type_name("FILE.mcap");
  add_file(*command, "--overlay", options->overlay,
           "folder for stills of each plan in the camera image: the robot at start, goal and minimum "
           "clearance, or where to paint more",
           "DIR");
  command
      ->add_option(
          "--video-out", options->video,
          "write a video of the recording with paint, probe and refusals, then of the robot's motion")
      ->check(file_of_kind(".mp4"))
      ->type_name("FILE.mp4");
  add_seen_within(*command, options->seen_within, "; default: the queries' own");
  command->add_flag_callback(
      "--no-plan", [options] { options->plan = false; }, "stop after the map");
  add_planning_flags(*command, options->seed, options->time_limit);
  return [options](Console& c) { return run_replay(*options, c); };
}

Command add_teach(CLI::App& app, Console& console) {
  auto options = std::make_shared<TeachCommand>();
  CLI::App* command = add_command(
      app, "teach",
      "interactive session: paint free space, pick start and goal with a probe, plan and approve", console);
  add_source(*command, options->source, options->camera_seconds, "source",
             "a recording with images (see replay), or the folder of a recorded session");
  command
      ->add_option(
          "--setup", options->setup,
          "tag boards, ball probe, gripper probe and robot, by file or name; default: the recording's own")
      ->type_name("SETUP.yaml");
  command
      ->add_option("--events", options->events,
                   "user actions: one timed JSON object per line; default: keys pressed in the window")
      ->type_name("FILE.jsonl");
  command
      ->add_option("--keys", options->keys,
                   "additional key bindings, such as for a robot, a volume or a load: events with 'key' "
                   "instead of 'time'")
      ->type_name("FILE.jsonl");
  command->add_flag("--headless", options->headless, "run without a window");
  add_file(*command, "--overlay", options->overlay,
           "folder for stills of each plan in the camera image: start, goal, minimum clearance", "DIR");
  command->add_option("--video-out", options->video, "write the session's images as a video")
      ->type_name("FILE.mp4")
      ->check(file_of_kind(".mp4"));
  add_file(*command, "--out", options->out,
           "folder for what replay writes, approved/, and session/ for repeating it", "DIR")
      ->required();
  add_map_flags(*command, options->resolution, options->integration, options->threads);
  add_planning_flags(*command, options->seed, options->time_limit);
  return [options](Console& c) { return run_teach(*options, c); };
}

}  // namespace clearway
