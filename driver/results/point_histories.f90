module point_histories
  !! HISTory of a material point: the place on a surface that is nearest to the point that the deck gives, in the
  !! reference position. A control point of a spline is no material point: its displacement is another one.
  !!
  !!     HISTory label SURFace=name POINt=x y [z] DISPlacement
  !!
  !! With the functions R_a of the facet there, u = R_a(xi) u_a.
  use kinds, only: wp
  use status_codes, only: ok
  use messages, only: message_log, quoted
  use number_text, only: write_number
  use closest_point, only: find_closest_point_global, projection_report
  use rational_basis, only: shape_functions
  use facets, only: facet_surface, build_facets
  use model_data, only: model_type, history_request
  use mesh_draft, only: draft_type
  use interface_commands, only: surface_of
  implicit none (type, external)
  private
  public :: resolve_point_histories, point_displacement

  real(wp), parameter :: most_distance = 0.01_wp   !! of the point from the surface, over the surface's size

contains

  subroutine resolve_point_histories(model, draft, log)
    !! After resolve_histories.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    type(message_log), intent(inout) :: log
    real(wp) :: distance, size_
    integer :: i, set

    do i = 1, size(draft%histories)
      associate (request => draft%histories(i))
        if (.not. allocated(request%surface)) cycle
        set = surface_of(model, draft, request%at, 'HISTory', 'surface', request%surface, log)
        if (set == 0) cycle
        if (.not. has_facets(model, set)) then
          call log%add_error(request%at, 'HISTory', 'the surface ' // quoted(request%surface) // ' has edges of shells', &
            'A point lies on a shell or on a side of a solid')
          cycle
        end if
        call place_on_surface(model, set, request%point(1:model%ndm), model%histories(i), distance, size_)
        if (.not. distance <= most_distance*size_) call log%add_error(request%at, 'HISTory', 'the point is ' // &
          write_number(distance) // ' away from the surface ' // quoted(request%surface), &
          'POINt is a place on the undeformed surface')
      end associate
    end do
  end subroutine resolve_point_histories

  logical function has_facets(model, set)
    !! Whether all parts of a surface have one dimension less than space.
    type(model_type), intent(in) :: model
    integer, intent(in) :: set

    associate (items => model%sets(set)%items, sides => model%sets(set)%sides)
      has_facets = all(model%mesh%dp(items) - merge(1, 0, sides > 0) == model%ndm - 1)
    end associate
  end function has_facets

  subroutine place_on_surface(model, set, point, history, distance, size_)
    !! Nodes and functions of the surface at the place nearest to a point.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: set                       !! index into model%sets (surface)
    real(wp), intent(in) :: point(:)                 !! (ndm) [length]
    type(history_request), intent(inout) :: history
    real(wp), intent(out) :: distance                !! huge if there is no such place [length]
    real(wp), intent(out) :: size_                   !! of the surface [length]
    type(facet_surface), target :: surface
    type(projection_report) :: report
    real(wp) :: xi(model%ndm - 1), best_xi(model%ndm - 1), low(model%ndm), high(model%ndm), no_slopes(0, 0)
    integer, pointer, contiguous :: nodes(:)
    integer :: f, best, status

    call build_facets(model, set, surface)
    distance = huge(distance)
    low = huge(low)
    high = -huge(high)
    best = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      low = min(low, minval(model%x(:, nodes), 2))
      high = max(high, maxval(model%x(:, nodes), 2))
      call find_closest_point_global(surface%set%degree(1:model%ndm - 1, f), model%w(nodes), surface%set%operator(f), &
                                     model%x(:, nodes), point, xi, report, status)
      if (report%distance < distance) then
        distance = report%distance
        best = f
        best_xi = xi
      end if
    end do
    size_ = norm2(high - low)
    if (best == 0) return
    nodes => surface%set%connectivity(best)
    history%nodes = nodes
    allocate (history%shares(size(nodes)))
    call shape_functions(surface%set%degree(1:model%ndm - 1, best), model%w(nodes), surface%set%operator(best), best_xi, 0, &
                         history%shares, no_slopes, no_slopes, status)
    if (status /= ok) distance = huge(distance)
  end subroutine place_on_surface

  pure function point_displacement(history, u, ndm) result(value)
    !! Displacement of the material point of a history.
    type(history_request), intent(in) :: history
    real(wp), intent(in) :: u(:, :)                  !! control values (ndf,nn)
    integer, intent(in) :: ndm
    real(wp) :: value(ndm)
    integer :: a

    value = 0
    do a = 1, size(history%nodes)
      value = value + history%shares(a)*u(1:ndm, history%nodes(a))
    end do
  end function point_displacement
end module point_histories
