#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {
namespace {

/// Pictures of the map, and files of it for other programs.
void add_pictures(CLI::App& command, InspectOptions& options) {
  command.add_option("--slice", options.slices, "draw a plane of the map as PNG: z=0.3 slice.png")
      ->type_name("z=M FILE.png")
      ->expected(1)
      ->take_all();
  add_repeatable(command, "--term", options.terms,
                 "draw a plane of the map in the terminal: z=0.3; repeatable", "z=M");
  command
      .add_option("--clearance", options.clearance,
                  "add lines of equal clearance to the slices: painted, known_free or not_occupied")
      ->type_name("POLICY");
  command.add_flag(
      "--age", options.age,
      "colour free voxels of the slices by age: the time from their last to the newest observation");
  command.add_flag(
      "--whole", options.whole,
      "slices and page reach to the farthest voxel; else a few that are far from all others are left "
      "out, and counted");
  add_repeatable(
      command, "--export", options.exports,
      "write .ot (all states, by colour), .bt (occupied and conflict against all that is free), .pcd or "
      ".ply (centres of occupied and conflict voxels alone) for other programs; repeatable",
      "FILE");
  add_file(command, "--view", options.view, "write an HTML page with the map in 3D", "FILE.html");
}

/// A new map made of this one, in this order.
void add_edits(CLI::App& command, InspectOptions& options) {
  add_file(command, "--merge", options.merge,
           "merge another map of the same resolution: occupied in either is occupied, volumes are "
           "united by label, each voxel keeps its later observation (both maps must share one clock)",
           "MAP2");
  add_file(command, "--paint", options.paint,
           "paint the spheres of a painted.csv, as replay writes it (after --merge): columns volume, "
           "label, critical_parts, x, y, z, radius, time, and stroke, stroke_label, source or none of these; "
           "volumes are united by label",
           "FILE.csv");
  add_repeatable(command, "--clear", options.clear,
                 "make the voxels wholly inside a shape seen free (after --paint): as --occupy; repeatable",
                 "SHAPE");
  add_repeatable(command, "--occupy", options.occupy,
                 "make the voxels that a shape meets occupied (after --clear): box:X,Y,Z,SX,SY,SZ, "
                 "sphere:X,Y,Z,R or cylinder:X,Y,Z,R,H about its middle, metres; then YAW or ROLL,PITCH,YAW, "
                 "radians; repeatable",
                 "SHAPE");
  command.add_option("--crop", options.crop, "keep only the voxels of a box (after --occupy), metres")
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command
      .add_option("--coarsen", options.coarsen,
                  "coarsen to voxels of M metres, 2, 4, 8 ... times the map's (after --crop): painted if "
                  "all voxels are, occupied if any is")
      ->check(positive())
      ->type_name("M");
  add_file(command, "--save", options.save, "write the new map to this folder, which must not be MAP", "DIR");
}

}  // namespace

Command add_inspect(CLI::App& app, Console& console) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = add_command(app, "inspect", "query, draw, compare and edit maps", console);
  add_map(*command, options->map, options->cloud_resolution, "map",
          "; or a bag, rawlog, scan graph or video, to list it")
      ->required();
  add_repeatable(*command, "--at", options->at,
                 "print what the map knows of a point, and when it was last seen; repeatable", "X,Y,Z");
  command->add_flag(
      "--holes", options->holes,
      "report the quality of each painted volume: exact volume, surface, spacing, holes, thin necks");
  add_pictures(*command, *options);
  add_repeatable(*command, "--ray", options->rays,
                 "cast a ray from O in direction D: voxel states up to the first blocked voxel; repeatable",
                 "OX,OY,OZ,DX,DY,DZ");
  command->add_flag("--conflicts", options->conflicts,
                    "list where painted space was observed occupied, when, and which came second");
  add_file(*command, "--diff", options->diff,
           "count the voxels whose state differs from another map, whatever their age; --slice, "
           "--term and --view then show what is other in MAP2; exit status 1 if the maps differ",
           "MAP2");
  add_edits(*command, *options);
  return [options](Console& c) { return run_inspect(*options, c); };
}

}  // namespace clearway
