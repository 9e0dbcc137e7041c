"""
A film with asperities
======================

Pressure and film of two cylinders that roll and slide, smooth and rough.
"""

import matplotlib.pyplot as plt

from easeoff.friction.ehl import Asperities, LubricatedContact, Oil, mixed_film, smooth_film

oil = Oil(viscosity=0.0208, pressure_viscosity=11.4e-9, eyring_stress=5e6)  # 75W90 at 75 degC
contact = LubricatedContact(
    hertz_pressure=1.0e9, equivalent_radius=0.020, rolling_velocity=5.0, oil=oil, slide_to_roll=0.25
)
smooth = smooth_film(contact)
mixed = mixed_film(contact, Asperities(composite_roughness=0.42e-6, correlation_length=20e-6))
print(smooth.status.name, f"{1e6 * smooth.minimum_film:.3f} um")
print(mixed.status.name, f"asperities carry {100 * mixed.asperity_share:.0f} %")

figure, (above, below) = plt.subplots(2, 1, figsize=(7, 5), sharex=True, layout="constrained")
for film, name in ((smooth, "smooth"), (mixed, "rough")):
    above.plot(1e3 * film.position, 1e-9 * film.pressure, label=name)
    below.plot(1e3 * film.position, 1e6 * film.film)
above.plot(1e3 * mixed.position, 1e-9 * mixed.asperity_pressure, "--", label="of asperities")
above.set(ylabel="pressure [GPa]")
above.legend()
below.set(xlabel="along the film [mm]", ylabel="film [um]", ylim=(0, 2), xlim=(-1.0, 0.6))
plt.show()
