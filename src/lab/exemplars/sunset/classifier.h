// Which class each pixel belongs to, judged by its colour and by its height: the stand-in for the
// exemplar's network.
//
// Like the exemplar's it fuses late. Two experts look at one modality each and say P(class | what
// they see); taking colour and height as independent given the class,
//
//     P(class | colour, height)  ~  P(class | colour) * P(class | height) / P(class).
//
// An expert is a table, fitted by counting the pixels of rendered frames whose truth is known. With
// n the counts, a = 10 and e = 0.014,
//
//     P(class | bin) = (1 - e) * (n(class, bin) + a * P(class)) / (n(bin) + a) + e * P(class).
//
// So an expert that has seen a bin often is sure of it, but never surer than that it may be fooled
// one time in 1 / e; and a bin that it has never seen, such as a colour that no healthy camera
// delivers, leaves it with the prior. Unknown colours and experts that contradict one another make
// the entropy rise. Nothing else does.
#pragma once

#include <array>
#include <vector>

#include "exemplars/sunset/image.h"

namespace culprit::sunset {

// The probability of each class, in the order of Label; sums to 1.
using Distribution = std::array<float, kLabelCount>;

class Classifier {
 public:
  // Fits the model to towns of its own, always the same, in about 0.2 s. No run shall use their
  // seeds, 0x5eed0000 to 0x5eed0003.
  Classifier();

  // An empty image stands for a modality that is not there (the exemplar's `modality`): its expert
  // says the prior. Throws std::invalid_argument if both are there and differ in size. Thread-safe.
  Image<Distribution> probabilities(const RgbImage& rgb, const DepthImage& depth) const;

 private:
  Distribution prior_{};
  std::vector<Distribution> colour_expert_;
  std::vector<Distribution> height_expert_;
};

LabelImage most_likely(const Image<Distribution>& probabilities);

// The exemplar's "entropy" of a frame: -p log2 p, averaged over classes and pixels. From 0 (sure of
// every pixel) to log2(8) / 8 = 0.375; 0 for an empty image. The published threshold of 0.06 lies
// between healthy frames (about 0.03) and bad ones (above 0.065) without any further scaling.
double entropy(const Image<Distribution>& probabilities);

}  // namespace culprit::sunset
