#pragma once

namespace irsig {

// Returns the temperature of a black sky that sends as much as a clear one above air of this
// temperature: 0.0552 T^1.5 [swinbank1963]. [K]
[[nodiscard]] double swinbank_sky_k(double air_k);

// Returns the irradiance of a sky that sends sky_w_m2 above air of from_k, above air of to_k: its
// emissivity stays.
[[nodiscard]] double sky_of_other_air_w_m2(double sky_w_m2, double from_k, double to_k);

}  // namespace irsig
