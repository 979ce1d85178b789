// Index extension beyond the border of a grid.
//
// Half-sample symmetry (... 1 0 | 0 1 2 ... n-1 | n-1 n-2 ...) is the extension of every analysis
// image; it is defined for any index (several reflections) and for n = 1.
#pragma once

namespace spool {

enum class Extension { kSymmetric, kClamp, kPeriodic, kWhole };

inline int extend_symmetric(int i, int n) {
  if (i >= 0 && i < n) return i;  // as usual, and without a division
  const int period = 2 * n;
  int j = i % period;
  if (j < 0) j += period;
  return j < n ? j : period - 1 - j;
}

inline int extend(int i, int n, Extension rule) {
  if (i >= 0 && i < n) return i;  // as usual, and without a division
  switch (rule) {
    case Extension::kSymmetric:
      return extend_symmetric(i, n);
    case Extension::kClamp:
      return i < 0 ? 0 : (i >= n ? n - 1 : i);
    case Extension::kPeriodic: {
      const int j = i % n;
      return j < 0 ? j + n : j;
    }
    case Extension::kWhole: {  // ... 2 1 | 0 1 2 ... n-1 | n-2 ...
      if (n == 1) return 0;
      const int period = 2 * n - 2;
      int j = i % period;
      if (j < 0) j += period;
      return j < n ? j : period - j;
    }
  }
  return 0;
}

}  // namespace spool
