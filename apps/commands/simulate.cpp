#include "datasets/simulation/simulate.hpp"

#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/console/table.hpp"
#include "datasets/descriptions/scene.hpp"

namespace clearway {

int run_simulate(const SimulateOptions& options, Console& console) {
  const std::filesystem::path file = shipped_file("scenes", options.scene);
  const Scene scene = load_scene(file);
  std::vector<NamedPlace> inputs = {{"SCENE", file}};
  for (const SceneInclude& include : scene.includes) inputs.push_back({"the scene", include.recording});
  require_apart(
      {{"--out", options.out}, {"truth.json beside --out", options.out.parent_path() / "truth.json"}},
      inputs);
  const SimulationResult result = simulate(scene, options.out, console.bar("rendering"));
  if (console.json) {
    const nlohmann::ordered_json json{{"recording", result.recording.string()},
                                      {"truth", result.truth.string()},
                                      {"images", result.images},
                                      {"depth_images", result.depth_images},
                                      {"included_frames", result.included_frames},
                                      {"duration_s", result.duration},
                                      {"stroke_length_m", result.stroke_length}};
    console.out() << json.dump(2) << '\n';
    return exit_done;
  }
  print_rows(console.out(), {{"images", grouped(result.images)},
                             {"depth images", grouped(result.depth_images)},
                             {"frames included", grouped(result.included_frames)},
                             {"stroke", significant(result.stroke_length, 3) + " m in " +
                                            significant(result.duration, 3) + " s"},
                             {"recording", result.recording.string()},
                             {"truth", result.truth.string()}});
  return exit_done;
}

}  // namespace clearway
