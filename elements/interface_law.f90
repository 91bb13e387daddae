module interface_law
  !! Normal traction of an interface over its gap: penalty in compression, bilinear cohesion in
  !! opening, switched by the gap alone; equations (32) and (43) of the paper, made irreversible:
  !!
  !!     p = eps g                                g < 0
  !!       = p_max g / g_max                      0 <= g < g_max
  !!       = p_max (g_u - g) / (g_u - g_max)      g_max <= g < g_u
  !!       = 0                                    g_u <= g                  G_Ic = p_max g_u / 2
  !!
  !! With h the largest opening so far, p = p(h) g / h for 0 <= g < h, g_max < h < g_u: unloading
  !! goes to the origin; with h >= g_u the point is spent and carries contact only. Contact alone is
  !! p_max = 0. The energy under the envelope splits into an elastic part p g / 2 and a dissipated
  !! part
  !!
  !!     D(h) = G_Ic (h - g_max) / (g_u - g_max)     g_max <= h < g_u
  !!
  !! As the paper prints it, the law is `reversible`: h never grows, nothing is dissipated, the
  !! elastic energy is the area under the envelope. At g = 0 of a point without cohesion the slope
  !! is that of contact, so that bodies which just touch feel each other.
  use kinds, only: wp
  use status_codes, only: ok, bad_law_data
  implicit none (type, external)
  private
  public :: gap_law, gap_response, contact_law, cohesive_law, cohesive_law_of_stiffness
  public :: interface_response, interface_is_active, dissipated_energy, interface_damage, has_cohesion

  type :: gap_law
    real(wp) :: penalty = 0             !! eps, stiffness in compression [stress/length]
    real(wp) :: p_max = 0               !! cohesive strength; 0 for contact alone [stress]
    real(wp) :: g_max = 0               !! opening at the strength [length]
    real(wp) :: g_u = 0                 !! opening at which the point is spent [length]
    logical :: reversible = .false.     !! unloading follows the envelope back
    real(wp) :: offset = 0              !! distance of the surfaces at which the gap is 0: half the
                                        !! thicknesses of shells [length]; for kernels
  end type gap_law

  type :: gap_response
    !! Energies are per unit area here, and integrated where a kernel returns them.
    real(wp) :: gap = 0                 !! normal gap, open > 0 [length]
    real(wp) :: traction = 0            !! p, tension > 0 [stress]
    real(wp) :: slope = 0               !! dp/dg [stress/length]
    real(wp) :: opening = 0             !! largest opening, this state's included: history [length]
    real(wp) :: penalty_energy = 0      !! stored by the penalty in compression
    real(wp) :: elastic_energy = 0      !! stored by the cohesion
    real(wp) :: dissipated = 0          !! D(h) since the intact state
    real(wp) :: dissipation_slope = 0   !! dD/dg: positive on the softening branch only
  end type gap_response

contains

  pure subroutine contact_law(penalty, law, status)
    !! Contact without cohesion.
    real(wp), intent(in) :: penalty     !! eps > 0 [stress/length]
    type(gap_law), intent(out) :: law
    integer, intent(out) :: status      !! ok, bad_law_data

    law%penalty = penalty
    status = merge(ok, bad_law_data, is_positive(penalty))
  end subroutine contact_law

  pure subroutine cohesive_law(penalty, p_max, toughness, g_max, law, status)
    !! Bilinear cohesion given by the opening at its strength.
    real(wp), intent(in) :: penalty     !! eps > 0 [stress/length]
    real(wp), intent(in) :: p_max       !! strength > 0 [stress]
    real(wp), intent(in) :: toughness   !! G_Ic > 0 [energy/area]
    real(wp), intent(in) :: g_max       !! opening at the strength, 0 < g_max < g_u [length]
    type(gap_law), intent(out) :: law   !! irreversible
    integer, intent(out) :: status      !! ok, bad_law_data

    status = bad_law_data
    if (.not. (is_positive(penalty) .and. is_positive(p_max) .and. is_positive(toughness) &
      .and. is_positive(g_max))) return
    law%penalty = penalty
    law%p_max = p_max
    law%g_max = g_max
    law%g_u = 2 * toughness / p_max
    if (g_max < law%g_u) status = ok
  end subroutine cohesive_law

  pure subroutine cohesive_law_of_stiffness(penalty, p_max, toughness, stiffness, law, status)
    !! Bilinear cohesion given by its initial stiffness p_max / g_max.
    real(wp), intent(in) :: penalty     !! eps > 0 [stress/length]
    real(wp), intent(in) :: p_max       !! strength > 0 [stress]
    real(wp), intent(in) :: toughness   !! G_Ic > 0 [energy/area]
    real(wp), intent(in) :: stiffness   !! p_max / g_max > p_max^2 / (2 G_Ic) [stress/length]
    type(gap_law), intent(out) :: law   !! irreversible
    integer, intent(out) :: status      !! ok, bad_law_data

    status = bad_law_data
    if (.not. is_positive(stiffness)) return
    call cohesive_law(penalty, p_max, toughness, p_max / stiffness, law, status)
  end subroutine cohesive_law_of_stiffness

  pure subroutine interface_response(law, gap, opening_n, response)
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: gap                  !! normal gap [length]
    real(wp), intent(in) :: opening_n            !! committed largest opening, >= g_u if unbonded
                                                 !! [length]
    type(gap_response), intent(out) :: response
    real(wp) :: reached                          !! h, by which unloading is judged
    real(wp) :: secant                           !! p(h) / h
    real(wp) :: softening                        !! p_max / (g_u - g_max)

    response%gap = gap
    response%opening = opening_n
    if (.not. law%reversible) response%opening = max(opening_n, gap, 0.0_wp)
    reached = merge(0.0_wp, response%opening, law%reversible .and. has_cohesion(law, opening_n))
    response%dissipated = dissipated_energy(law, response%opening)

    if (gap < 0 .or. (gap <= 0 .and. .not. has_cohesion(law, opening_n))) then
      response%traction = law%penalty * gap
      response%slope = law%penalty
      response%penalty_energy = law%penalty * gap**2 / 2
    else if (.not. has_cohesion(law, reached) .or. gap >= law%g_u) then
      if (law%reversible .and. has_cohesion(law, opening_n)) &
        response%elastic_energy = law%p_max * law%g_u / 2
    else if (gap < max(reached, law%g_max)) then
      secant = law%p_max / law%g_max
      if (reached > law%g_max) &
        secant = law%p_max * (law%g_u - reached) / ((law%g_u - law%g_max) * reached)
      response%traction = secant * gap
      response%slope = secant
      response%elastic_energy = secant * gap**2 / 2
    else
      softening = law%p_max / (law%g_u - law%g_max)
      response%traction = softening * (law%g_u - gap)
      response%slope = -softening
      if (law%reversible) then
        response%elastic_energy = (law%p_max * law%g_u - response%traction * (law%g_u - gap)) / 2
      else
        response%elastic_energy = response%traction * gap / 2
        response%dissipation_slope = softening * law%g_u / 2
      end if
    end if
  end subroutine interface_response

  elemental function interface_is_active(law, gap, opening_n) result(active)
    !! Whether a point with this gap can carry traction, so that the search may skip the kernel
    !! where it can't.
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: gap         !! [length]
    real(wp), intent(in) :: opening_n   !! committed largest opening [length]
    logical :: active

    active = gap <= 0 .or. (gap < law%g_u .and. has_cohesion(law, opening_n))
  end function interface_is_active

  elemental function dissipated_energy(law, opening) result(dissipated)
    !! D(h). A point that was unbonded from the start holds G_Ic by this measure: subtract its
    !! initial value.
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: opening     !! h [length]
    real(wp) :: dissipated              !! [energy/area]

    if (law%reversible .or. opening <= law%g_max .or. law%p_max <= 0) then
      dissipated = 0
    else if (opening < law%g_u) then
      dissipated = law%p_max * law%g_u / 2 * (opening - law%g_max) / (law%g_u - law%g_max)
    else
      dissipated = law%p_max * law%g_u / 2
    end if
  end function dissipated_energy

  elemental function interface_damage(law, opening) result(damage)
    !! Share of the initial stiffness that is lost, p(h)/h = (1 - damage) p_max/g_max: 0 intact, 1 spent.
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: opening     !! h [length]
    real(wp) :: damage

    damage = 0
    if (.not. has_cohesion(law, opening)) then
      damage = 1
    else if (opening > law%g_max) then
      damage = law%g_u * (opening - law%g_max) / (opening * (law%g_u - law%g_max))
    end if
  end function interface_damage

  elemental function has_cohesion(law, opening) result(bonded)
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: opening     !! h [length]
    logical :: bonded                   !! cohesion is left

    bonded = law%p_max > 0 .and. opening < law%g_u
  end function has_cohesion

  elemental function is_positive(value) result(positive)
    real(wp), intent(in) :: value
    logical :: positive                 !! false for NaN and infinity too

    positive = value > 0 .and. value <= huge(value)
  end function is_positive
end module interface_law
