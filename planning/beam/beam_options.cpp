#include "planning/beam/beam_options.hpp"

#include "planning/problem/option_reader.hpp"

namespace clearway {

BeamOptions read_options(OptionReader& reader, BeamOptions initial) {
  return {.width = reader.integer("width", initial.width, 1, 100000),
          .step = reader.numbers_or_auto("step", initial.step, 1e-6, 10.0),
          .step_deg = reader.numbers_or_auto("step_deg", initial.step_deg, 1e-4, 180.0),
          .max_steps = reader.integer_or_auto("max_steps", initial.max_steps, 1, 100000000),
          .last_segment = reader.flag("last_segment", initial.last_segment),
          .node_only = reader.flag("node_only", initial.node_only),
          .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6)};
}

}  // namespace clearway
