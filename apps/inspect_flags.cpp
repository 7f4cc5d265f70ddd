#include <CLI/CLI.hpp>
#include <memory>

#include "apps/commands.hpp"
#include "apps/flags.hpp"

namespace clearway {

Command add_inspect(CLI::App& app, Console& console) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = add_command(app, "inspect", "look at any map", console);
  command->add_option("map", options->map, "folder written by replay, or .ot, .bt, .pcd, .ply")
      ->required()
      ->type_name("MAP");
  command->add_option("--at", options->at, "what is known of one point, metres; repeatable")
      ->type_name("X,Y,Z")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag("--holes", options->holes,
                    "quality of each painted volume: exact volume, surface, spacing, holes, thin necks");
  command->add_option("--slice", options->slices, "draw a plane of the map as PNG: z=0.3 slice.png")
      ->type_name("z=M FILE.png")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--export", options->exports,
                   "write .ot (coloured), .bt, .pcd or .ply for other programs; repeatable")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--view", options->view, "write a page that shows the map in 3D")
      ->type_name("FILE.html")
      ->check(file_name);
  return [options](Console& c) { return run_inspect(*options, c); };
}

}  // namespace clearway
