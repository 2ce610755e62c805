#pragma once

#include <string>
#include <vector>

#include "core/signature/prepared_scene.h"
#include "schema/job.pb.h"

namespace irsig {

// What is odd about a model from a file, for people, each as "<path>: <what>". One-sided parts with
// facets of open shells (not where the sweep states model.accepted_backface_share); a size that
// suggests another unit; axes that suggest others; over a sea or ground, where it floats or stands.
[[nodiscard]] std::vector<std::string> model_warnings(const schema::ResolvedSweep& sweep,
                                                      const SceneSpec& scene);

}  // namespace irsig
