#pragma once

#include <vector>

namespace clearway {

class OptionReader;

/// Options of the beam search, of `beam` and of `beam_reference`.
struct BeamOptions {
  int width = 10;                 ///< k, the maximum width of the beam, 1 to 100,000
  std::vector<double> step = {};  ///< epsilon_j, 1e-6 to 10 rad or m, one or one for each joint; auto: the
                                  ///< robot's own
  std::vector<double> step_deg = {};  ///< the same in degrees, 1e-4 to 180, of revolute joints; goes before
                                      ///< `step`
  int max_steps = 0;         ///< of the search, 1 to 100,000,000; auto (0): 20 max_j |dq_j| / epsilon_j + 200
  bool last_segment = true;  ///< append the certified segment to the exact goal
  bool node_only = false;    ///< check nodes only, as the paper does: paths are then not certified
  double prismatic_scale = 0.0;  ///< rad per metre in Chong 2008, eq. 10, up to 1e6; 0: see joint_weights
};

/// @throws std::invalid_argument as OptionReader does.
BeamOptions read_options(OptionReader& reader, BeamOptions initial);

}  // namespace clearway
