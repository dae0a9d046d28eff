"""The claims of the page, in its order. Each row belongs to one of them."""

from . import bed, bed_pairs, fits, noise, theory_field, theory_pairs
from .entry import Subject

ROWS = {row.id: row for subject in (theory_field.FIELD, theory_pairs.PAIRS, bed.BED, bed_pairs.PAIRS, noise.NOISE, fits.WAKE_ROWS) for row in subject.rows}
CLAIMS = (
    ("The wake is long behind the rod and short ahead of it: theory", "uxuy nu tail screened ufield_b ufield_d ufield_e_theory"),
    ("The wake is long behind the rod and short ahead of it: bed",
     "ufield_a ufield_c wake_map wake_side ufield_e ufield_e_large ufield_e_pulled tail_sides tail_ahead tail_power"),
    ("The theory describes the bed's displacement field",
     "fit_f fit_eta fit_alpha fit_chi2 ufield2_b ufield2_c ufield2_c_all ufield2_d newcal_eta newcal_f newcal_f2 newcal_xi newcal_ux"),
    ("Rods attract in the crystal and separate in the liquid",
     "attraction_a attraction_b trajectory_c trajectory_c_fit trajectory_c_fit_90 trajectory_d_inset trajectory_d_fluid trajectory_d_crystal "
     "trajectory_d_change trajectory_d_weak trajectory_a trajectory_b_fluid trajectory_b_crystal one_straight apolar_pair noise_capture noise_average"),
    ("The rear rod pursues the front rod, which hardly responds",
     "nonrecip_a kappa_100 kappa_positive closure_attraction closure_pursuit nonrecip_b nonrecip_b_end nonrecip_c nonrecip_c_dish nonrecip_c_end "
     "nonrecip_c_fit"),
    ("Strain turns the rods, polar couplings do not capture",
     "sup_ufield pletraj_a pletraj_b gamma_all gamma_kappa kappa_negative strain_crystal strain_fluid strain_sign"),
    ("The bed is a crystal that motile rods strain",
     "apparatus lone_rod lone_apolar motile_crystal hop_a hop_a_end hop_b_low hop_b_high micro_a_low micro_a micro_b bead_drag_a bead_drag_c "
     "bead_drag_b bead_drag_d rel_fv"),
)
ALL = (*(Subject(title, tuple(ROWS[name] for name in names.split())) for title, names in CLAIMS), bed_pairs.FILMS)
