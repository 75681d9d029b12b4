#pragma once
/// Zero-phase low-pass filter of measured signals.
#include <vector>

namespace tuft::rigs {

/// Second-order Butterworth run forwards and backwards (four poles, no phase shift): the digital filter of
/// SAE J211-1, Appendix C. The two passes together are 3 dB down at `cutoff`: each pass is designed for
/// cutoff / (sqrt(2) - 1)^(1/4). The ends are continued by point reflection, so that a constant and a ramp
/// pass unchanged. values: equally spaced by `interval` (s); 0 < cutoff < 0.4 / interval (Hz). Throws
/// InputError outside that range.
[[nodiscard]] std::vector<double> zero_phase_lowpass(const std::vector<double>& values, double interval,
                                                     double cutoff);

}  // namespace tuft::rigs
