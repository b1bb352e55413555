// SPDX-License-Identifier: MIT
/// An outside program: includes an installed header, links the library, and trusts what it gets.
#include <pointsweep/points/schema.h>

#include <cstdio>

int main() {
  pointsweep::Schema schema;
  for (const char* name : {"x", "y", "z"}) schema.append(name, pointsweep::Type::f64);
  const bool right = schema.stride == 24 && schema.find("z") == 2u;
  std::printf("%s\n", right ? "pointsweep is installed" : "pointsweep gives a wrong answer");
  return right ? 0 : 1;
}
