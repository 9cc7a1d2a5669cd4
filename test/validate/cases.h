// The cases of the validation, each one scene; results go to result() in strip.h.
#pragma once

/// reference.c against the curves of ../shared/data, where they are there.
void case_reference(void);
void case_cantilever(int mesh, double gamma, const char *model, int cells); // cells 0: as needed
void case_mesh_order(int mesh, double gamma);
void case_tip_load(int mesh, double load, const char *model);
void case_end_moment(int mesh, const char *model);
void case_heart_loop(int mesh, double gamma, const char *model);
void case_hanging_sheet(int mesh, int mode);
void case_catenary(int mesh, double apart); // share of its length between its ends

void case_stick_slips(int quick); // against the curve of ../shared/data, where it is there
void case_stick_slip(int mesh, double mu, const double *curve, int rows);
void case_capstan(int mesh, double mu);
void case_slope(int mesh, double mu);

/// Share of the ring that still shows; within [least, most] is a pass.
double case_drape(const char *fabric, int rings, double least, double most);
