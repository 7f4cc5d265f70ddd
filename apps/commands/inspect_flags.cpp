#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_inspect(CLI::App& app, Console& console) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = add_command(app, "inspect", "look at any map", console);
  command->add_option("map", options->map, "folder written by replay, or .ot, .bt, .pcd, .ply")
      ->required()
      ->type_name("MAP");
  command
      ->add_option("--at", options->at, "what is known of one point, and when it was last seen; repeatable")
      ->type_name("X,Y,Z")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag("--holes", options->holes,
                    "quality of each painted volume: exact volume, surface, spacing, holes, thin necks");
  command->add_option("--slice", options->slices, "draw a plane of the map as PNG: z=0.3 slice.png")
      ->type_name("z=M FILE.png")
      ->expected(1)
      ->take_all();
  command->add_option("--term", options->terms, "draw a plane of the map in the terminal: z=0.3; repeatable")
      ->type_name("z=M")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option("--clearance", options->clearance,
                   "add lines of equal clearance to the slices: painted, known_free or not_occupied")
      ->type_name("POLICY");
  command->add_flag(
      "--age", options->age,
      "colour what was seen free in the slices by how long before the newest look it was last seen");
  command
      ->add_option("--export", options->exports,
                   "write .ot (coloured), .bt, .pcd or .ply for other programs; repeatable")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--view", options->view, "write a page that shows the map in 3D")
      ->type_name("FILE.html")
      ->check(file_name);
  command
      ->add_option("--ray", options->rays,
                   "states along a ray from O in direction D up to the first blocked voxel; repeatable")
      ->type_name("OX,OY,OZ,DX,DY,DZ")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag("--conflicts", options->conflicts,
                    "list where painted space turned out occupied, when, and what came second");
  command
      ->add_option(
          "--diff", options->diff,
          "count the voxels that differ from another map, by state, whenever they were seen; --slice, --term "
          "and --view then show the difference; status 1 when the maps differ")
      ->type_name("MAP2")
      ->check(file_name);
  command
      ->add_option(
          "--merge", options->merge,
          "add another map of the same resolution: what either calls occupied stays occupied, volumes united "
          "by label, the later look of each voxel (the clocks of both count as one)")
      ->type_name("MAP2")
      ->check(file_name);
  command->add_option("--crop", options->crop, "keep the voxels of a box only (after --merge), metres")
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command
      ->add_option("--coarsen", options->coarsen,
                   "voxels of M metres, 2, 4, 8 ... times the map's (after --crop): painted only where all "
                   "voxels are, occupied where any is")
      ->check(positive())
      ->type_name("M");
  command
      ->add_option("--save", options->save,
                   "write the merged, cropped or coarser map into this folder, another than MAP")
      ->type_name("DIR")
      ->check(file_name);
  return [options](Console& c) { return run_inspect(*options, c); };
}

}  // namespace clearway
