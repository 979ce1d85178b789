// Dilated separable convolution of an image, whole or on a rectangle of its output.
//
//   (h *_D f)(x, y) = sum_n h(n) sum_m h(m) f(ext(x - m D), ext(y - n D))
//
// Rows first, then columns; in both the taps are added in the order of their offsets. Each output
// depends on its inputs alone, so a rectangle, the whole image and any number of threads give the
// same bits. T is double or float (taps are rounded to T once).
// Slow twin: tests/reference/convolution_reference.h.
#pragma once

#include "lib/core/extend.h"
#include "lib/core/image.h"
#include "lib/core/rectangle.h"
#include "lib/pyramid/wavelet_filters.h"

namespace spool {

// Writes taps *_dilation in on `box` of `out` (same size as `in`, another image); the rest of `out`
// keeps its values. box must lie inside the image.
template <class T>
void convolve_box(const Image<T>& in, const Taps& taps, int dilation, Extension extension,
                  const Rectangle& box, Image<T>& out);

// out = minuend - taps *_dilation in, on `box`.
template <class T>
void subtract_convolved_box(const Image<T>& minuend, const Image<T>& in, const Taps& taps,
                            int dilation, Extension extension, const Rectangle& box, Image<T>& out);

// The same with the input masked to one polyphase component: in(x, y) counts only where
// floor(x / D) and floor(y / D) are even (the sampling of phase (0, 0)).
template <class T>
void subtract_convolved_phase00_box(const Image<T>& minuend, const Image<T>& in, const Taps& taps,
                                    int dilation, Extension extension, const Rectangle& box,
                                    Image<T>& out);

template <class T>
Image<T> convolve(const Image<T>& in, const Taps& taps, int dilation = 1,
                  Extension extension = Extension::kSymmetric);

// gaussian_taps(sigma), symmetric extension; sigma in pixels.
template <class T>
Image<T> gaussian_blur(const Image<T>& in, double sigma,
                       Extension extension = Extension::kSymmetric);

// The smallest rectangle that holds every output that depends on an input inside `changed`:
// exact, with the reflections at the borders.
Rectangle convolution_influence(const Rectangle& changed, const Taps& taps, int dilation,
                                Extension extension, const Rectangle& bounds);

}  // namespace spool
