#pragma once

namespace irsig {

// Bond lengths [angstrom] and the cosine of the angle between them.
struct WaterShape {
  double bond1, bond2, cosine;
};

// Returns the potential energy of a water molecule above its minimum [cm-1], fitted to its observed
// levels: ab initio energies with three corrections [partridge1997, tables V and VI]. Valid to
// about 25000 cm-1, without the corrections for the finite mass of the nuclei.
[[nodiscard]] double water_potential_cm1(const WaterShape& shape);

// Charges of the hydrogen atoms [e] with which the dipole moment is the sum of charge times bond
// vector [partridge1997, table VII].
struct WaterCharges {
  double first, second;
};
[[nodiscard]] WaterCharges water_charges(const WaterShape& shape);

}  // namespace irsig
