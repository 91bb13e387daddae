module interface_leaps
  !! Refuses increments in which slave points may have passed through the master unnoticed: pairs are sought in the
  !! position of each iteration only, so that a point that moves by more than the search distance can lie in front of the
  !! master before and behind it after. Increments that are no longer than the search distance are never refused.
  use kinds, only: wp
  use status_codes, only: ok, no_convergence
  use model_data, only: model_type
  use equilibrium, only: equilibrium_type
  use newton, only: newton_report
  use contact_search, only: pair_point
  use interface_points, only: interface_points_type, place_of_slave, height_above_master
  implicit none (type, external)
  private
  public :: refuse_leaps

contains

  subroutine refuse_leaps(model, eq, report, status)
    !! After an increment has converged, and before it is committed.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_report), intent(inout) :: report     !! its fault says what was refused
    integer, intent(inout) :: status                 !! no_convergence if it is
    real(wp) :: leap
    integer :: i
    character(24) :: motion, reach

    if (status /= ok) return
    do i = 1, size(eq%interfaces)
      leap = largest_leap(model, eq%interfaces(i), eq%u(1:model%ndm, :) - eq%un(1:model%ndm, :))
      if (.not. leap > 0) cycle
      write (motion, '(es10.3)') leap
      write (reach, '(es10.3)') eq%interfaces(i)%search%reach
      status = no_convergence
      eq%leaps = eq%leaps + 1
      report%fault = 'slave points of '//model%interfaces(i)%name//' came to lie behind the master by a motion of '// &
        trim(adjustl(motion))//', longer than the search distance '//trim(adjustl(reach))//'; REACh can enlarge it'
      return
    end do
  end subroutine refuse_leaps

  function largest_leap(model, points, du) result(leap)
    !! Largest motion, relative to the master's mean motion, of a point that is not paired and lies behind the master, no
    !! farther from it than it may have moved; 0 where all motions are within reach.
    type(model_type), intent(in) :: model
    type(interface_points_type), intent(inout), target :: points
    real(wp), intent(in) :: du(:, :)   !! increment of the positions of all nodes (ndm,nn) [length]
    real(wp) :: leap                   !! [length]
    real(wp), dimension(model%ndm) :: mean, xs, way
    real(wp) :: xi(model%ndm - 1), stir, motion, height, reach
    logical :: held(model%ndm - 1), forced
    integer :: i, a, facet, status

    leap = 0
    if (all(points%facet > 0)) return
    associate (nodes => points%master%set%nodes(:points%master%set%node_ptr(points%master%set%ne + 1) - 1))
      mean = [(sum(du(a, nodes))/size(nodes), a=1, size(mean))]
      stir = 0
      do a = 1, size(nodes)
        stir = max(stir, norm2(du(:, nodes(a)) - mean))
      end do
    end associate
    reach = points%search%reach
    do i = 1, points%np
      if (points%facet(i) > 0) cycle
      call place_of_slave(du, points, i, way)
      motion = norm2(way - mean) + stir
      if (motion <= max(leap, reach)) cycle
      call place_of_slave(points%search%x, points, i, xs)
      facet = 0
      points%search%reach = motion
      call pair_point(points%search, points%master, model%w, xs, .false., facet, xi, held, forced)
      points%search%reach = reach
      if (facet == 0) cycle
      call height_above_master(model, points, points%search%x, i, facet, xi, height, status)
      if (status == ok .and. points%search%side*height < points%search%offset) leap = motion
    end do
  end function largest_leap
end module interface_leaps
