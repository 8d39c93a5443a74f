#include "experiments/cli/program.hpp"

int main(int argc, char** argv) {
    return loam::experiments::run_program(argc, argv);
}
