// The yardstick for watching pictures: what any program pays that reads them with Fast DDS.
#pragma once

namespace culprit::bench {

// Reads /bench/image until SIGTERM, over the same transport as the picture's writer has. Prints how
// many came.
void read_bare();

}  // namespace culprit::bench
