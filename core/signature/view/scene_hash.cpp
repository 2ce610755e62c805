#include "core/signature/view/scene_hash.h"

#include <concepts>
#include <type_traits>

namespace irsig {
namespace {

// Adds every number of a material's model.
struct AddProperty {
  Hash& hash;

  void operator()(MaterialKey /*key*/, double x) const { hash.add(x); }
  template <typename Choice>
  requires std::is_enum_v<Choice> || std::same_as<Choice, bool>
  void operator()(MaterialKey /*key*/, Choice x) const { hash.add(static_cast<std::uint64_t>(x)); }
  void operator()(MaterialKey /*key*/, const Spectrum& s) const {
    for (const SpectralPoint& p : s) {
      hash.add(p.lambda_um);
      hash.add(p.value);
    }
  }
  void operator()(MaterialKey /*key*/, const OpticalConstants& table) const {
    for (const OpticalConstant& c : table) {
      hash.add(c.lambda_um);
      hash.add(c.n);
      hash.add(c.k);
    }
  }
  void operator()(MaterialKey /*key*/, const TabulatedBrdf& m) const {
    for (const auto* list : {&m.lambda_um, &m.theta_i_deg, &m.theta_r_deg, &m.phi_deg})
      for (const double x : *list) hash.add(x);
    hash.add(m.brdf_per_sr);
  }
};

}  // namespace

void Hash::add(const MaterialSpec& spec) {
  add(static_cast<std::uint64_t>(spec.model.index()));
  for_each_property(spec.model, AddProperty{*this});
}

}  // namespace irsig
