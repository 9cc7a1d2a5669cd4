// The cases of the validation, each one scene; results go to result() in strip.h.
#pragma once

void case_cantilever(int mesh, double gamma, const char *model, int cells); // cells 0: as needed
void case_tip_load(int mesh, double load, const char *model);
void case_end_moment(int mesh, const char *model);
void case_heart_loop(int mesh, double gamma, const char *model);
