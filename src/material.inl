// Every property of a fabric, once: CLOTH_MATERIAL(name, default, unit, least, most, meaning).
// This list becomes the struct, the defaults, the range checks, the YAML reader (`materials:` and
// config/materials/*.yaml) and the table in doc/materials.md. The defaults are a light terry towel.
//
// Stiffnesses are those of the continuum, not of the mesh: halving the edge length changes nothing.
CLOTH_MATERIAL(density, 0.3, "kg/m^2", 1e-3, 1e2, "mass per area")
CLOTH_MATERIAL(stretch_warp, 2000, "N/m", 0, 1e7, "membrane stiffness E h along the warp; 0 with stretch_weft and shear 0: no membrane")
CLOTH_MATERIAL(stretch_weft, 2000, "N/m", 0, 1e7, "membrane stiffness E h along the weft")
CLOTH_MATERIAL(shear, 400, "N/m", 0, 1e7, "membrane shear stiffness G h")
CLOTH_MATERIAL(poisson, 0.25, "1", 0, 0.99, "contraction in the weft when stretched in the warp; nu^2 E_weft < E_warp")
CLOTH_MATERIAL(strain_limit, 0, "1", 0, 10, "principal stretch minus 1 beyond which the fabric stiffens hundredfold; 0: none")
CLOTH_MATERIAL(bend_warp, 5e-5, "N m", 0, 1e3, "bending rigidity D when the warp is curved")
CLOTH_MATERIAL(bend_weft, 5e-5, "N m", 0, 1e3, "bending rigidity D when the weft is curved")
CLOTH_MATERIAL(damping_stretch, 2e-3, "s", 0, 10, "membrane damping: viscous stress over elastic stiffness")
CLOTH_MATERIAL(damping_bend, 5e-3, "s", 0, 10, "bending damping, likewise")
CLOTH_MATERIAL(damping_mass, 0, "1/s", 0, 1e3, "drag against the scene frame, per mass")
CLOTH_MATERIAL(drag, 1.0, "1", 0, 10, "pressure drag coefficient of a face turned to the wind")
CLOTH_MATERIAL(skin_drag, 0.05, "1", 0, 10, "friction coefficient of air along a face")
#undef CLOTH_MATERIAL
