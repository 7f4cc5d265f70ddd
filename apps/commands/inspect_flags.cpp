#include <CLI/CLI.hpp>
#include <memory>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_inspect(CLI::App& app, Console& console) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command = add_command(app, "inspect", "query, draw, compare and edit maps", console);
  add_map(*command, options->map, options->cloud_resolution, "map", "; or a bag, rawlog or video, to list it")
      ->required();
  command
      ->add_option("--at", options->at,
                   "print what the map knows of a point, and when it was last seen; repeatable")
      ->type_name("X,Y,Z")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag(
      "--holes", options->holes,
      "report the quality of each painted volume: exact volume, surface, spacing, holes, thin necks");
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
      "colour free voxels of the slices by age: the time from their last to the newest observation");
  command
      ->add_option(
          "--export", options->exports,
          "write .ot (all states, by colour), .bt (occupied and conflict against all that is free), .pcd or "
          ".ply (centres of occupied and conflict voxels alone) for other programs; repeatable")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--view", options->view, "write an HTML page with the map in 3D")
      ->type_name("FILE.html")
      ->check(file_name);
  command
      ->add_option("--ray", options->rays,
                   "cast a ray from O in direction D: voxel states up to the first blocked voxel; repeatable")
      ->type_name("OX,OY,OZ,DX,DY,DZ")
      ->allow_extra_args(false)
      ->take_all();
  command->add_flag("--conflicts", options->conflicts,
                    "list where painted space was observed occupied, when, and which came second");
  command
      ->add_option("--diff", options->diff,
                   "count the voxels whose state differs from another map, whatever their age; --slice, "
                   "--term and --view then show what is other in MAP2; exit status 1 if the maps differ")
      ->type_name("MAP2")
      ->check(file_name);
  command
      ->add_option("--merge", options->merge,
                   "merge another map of the same resolution: occupied in either is occupied, volumes are "
                   "united by label, each voxel keeps its later observation (both maps must share one clock)")
      ->type_name("MAP2")
      ->check(file_name);
  command
      ->add_option(
          "--paint", options->paint,
          "paint the spheres of a painted.csv, as replay writes it (after --merge): columns volume, "
          "label, critical_parts, x, y, z, radius, time, and stroke, stroke_label, source or none of these; "
          "volumes are united by label")
      ->type_name("FILE.csv")
      ->check(file_name);
  command
      ->add_option("--clear", options->clear,
                   "make the voxels wholly inside a shape seen free (after --paint): as --occupy; repeatable")
      ->type_name("SHAPE")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option(
          "--occupy", options->occupy,
          "make the voxels that a shape meets occupied (after --clear): box:X,Y,Z,SX,SY,SZ, "
          "sphere:X,Y,Z,R or cylinder:X,Y,Z,R,H about its middle, metres; then YAW or ROLL,PITCH,YAW, "
          "radians; repeatable")
      ->type_name("SHAPE")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--crop", options->crop, "keep only the voxels of a box (after --occupy), metres")
      ->type_name("X0,Y0,Z0,X1,Y1,Z1");
  command
      ->add_option("--coarsen", options->coarsen,
                   "coarsen to voxels of M metres, 2, 4, 8 ... times the map's (after --crop): painted if "
                   "all voxels are, occupied if any is")
      ->check(positive())
      ->type_name("M");
  command->add_option("--save", options->save, "write the new map to this folder, which must not be MAP")
      ->type_name("DIR")
      ->check(file_name);
  return [options](Console& c) { return run_inspect(*options, c); };
}

}  // namespace clearway
