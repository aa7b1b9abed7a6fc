#include "main_view/app/command_line.hpp"

int main(int argc, char** argv) {
  return sightline::run_command_line(argc, argv);
}
