#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"
#include "messages/inputs/moved_sweep.h"
#include "runner/spec_to_request.h"
#include "schema/assets.h"
#include "schema/result.pb.h"

namespace irsig {

// The uncertain inputs of one sweep: the requests of its views with each input moved, and the
// resulting changes. Data made for an input are kept from view to view: an environment if the air
// differs, a prepared scene if materials differ.
class InputViews {
 public:
  // Creates the views. scene: the sweep's own, kept only if materials are moved. heat: outputs of
  // the sweep's heat jobs.
  static absl::StatusOr<InputViews> make(const schema::ResolvedSweep& sweep, const SceneSpec& scene,
                                         const Simulator& simulator,
                                         const std::shared_ptr<const Environment>& environment,
                                         const SweepTemperatures& temperatures,
                                         std::shared_ptr<const LandScene> land,
                                         const HeatOutputs& heat);

  // Uses the views of another sweep, which differs only in name, accuracy, viewpoints, profiles and
  // size of jobs.
  void look_as(const schema::ResolvedSweep& sweep);

  // Returns the moved views of one job, in the order of the moves.
  [[nodiscard]] absl::StatusOr<std::vector<MovedView>> views(const schema::ViewJob& job) const;

  // Effects that the moves can strengthen or weaken: no plan of a view leaves them out.
  [[nodiscard]] const std::vector<Effect>& moved_effects() const { return moved_effects_; }

  // Writes the changes by the moves as contributions of the inputs to each row and their sum.
  // change: [move][row]
  void write(std::span<const std::vector<RowChange>> change, schema::ViewJobResult& result) const;

 private:
  struct Move {
    std::size_t input;
    double move;
    schema::ResolvedSweep sweep;
    std::shared_ptr<const Environment> environment;
    SweepTemperatures temperatures;
    std::shared_ptr<const PreparedScene> scene;  // null: the sweep's
  };
  std::vector<UncertainInput> input_;
  std::vector<Move> move_;
  std::vector<Effect> moved_effects_;
  std::shared_ptr<const LandScene> land_;  // of all of them; null: none
};

// Returns the number of environments of a sweep's size that its moved inputs keep in memory.
[[nodiscard]] int moved_environments(const schema::ResolvedSweep& sweep);

}  // namespace irsig
