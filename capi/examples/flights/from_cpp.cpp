// Hovers for one step, from C++17.
#include <cmath>
#include <iostream>

#include <alula.h>

int main()
{
    alula_parameters parameters;
    alula_controller controller;
    alula_input input;
    alula_command command;
    parameters.header = ALULA_HEADER(alula_parameters);
    controller.header = ALULA_HEADER(alula_controller);
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    const int32_t defaults = alula_parameters_default(&parameters);
    parameters.vehicle.mass = 10.0f;
    parameters.vehicle.k_a = 0.646f;
    parameters.vehicle.thrust_max = 196.2f;
    for (int32_t code : {defaults, alula_init(&controller, &parameters, nullptr), alula_input_default(&input),
                         alula_step(&controller, &input, 0.01f, &command, nullptr)}) {
        if (code != ALULA_OK) {
            std::cerr << alula_strerror(code) << '\n';
            return 1;
        }
    }
    const float weight = parameters.vehicle.mass * parameters.vehicle.gravity;
    std::cout << "hover: " << command.thrust << " N of thrust for " << weight << " N of weight\n";
    // 1e-4: the default attitude's pitch is 90 degrees to a few units in the last place.
    return std::fabs(command.thrust / weight - 1.0f) < 1e-4f && std::fabs(command.body_rate[1]) < 1e-4f ? 0 : 1;
}
