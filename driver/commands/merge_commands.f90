module merge_commands
  !! MERGe: two patches with a common edge become one T-spline without gap, whatever their knots along the edge.
  !!
  !!     PATCh a [MATErial=m] [BODY=b]        each patch as ever, with the line PARTial: it is not added to the mesh
  !!     MERGe name a.right b.left [C0|C1|C2 ...] [TOLerance=t]
  !!       SWEEp vx vy vz DEGRee=r ELEMents=n [RATIo=q]
  !!
  !! The edges are sides of the patches, any of left, right, bottom, top; they must be the same curve with the same
  !! parameters (but for a shift and a factor) up to the tolerance (default: 1e-9 of the size of both). C0 keeps both
  !! surfaces; smoother seams round off what is not smooth (shapes/t_merge.f90).
  !!
  !! Sets: all elements are NAME, those of either patch have its name, material and body. The outer sides are the
  !! surfaces a.left and so on, as the patches name them, without the two edges. A swept solid has NAME.back, NAME.front.
  use kinds, only: wp
  use status_codes, only: ok, edges_differ, status_text
  use messages, only: message_log, quoted, in_place, string, known_names, lower_case, whole_text
  use number_text, only: write_number
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, set_elements, set_surface
  use model_sets, only: add_set, find_set
  use mesh_draft, only: draft_type
  use data_lines, only: next_line
  use element_commands, only: begin_origin
  use t_mesh, only: t_mesh_type
  use t_spline, only: t_spline_type
  use t_sweep, only: sweep_type
  use t_merge, only: merge_patches, turned_patch, side_before
  use nurbs_patch, only: nurbs_patch_type
  use t_patch_lines, only: read_sweep, report_suitability, surface_sides
  use t_bodies, only: t_body, add_t_body
  implicit none (type, external)
  private
  public :: read_merge, check_parts

  integer, parameter :: opposite(4) = [2, 1, 4, 3]     ! side of each side

contains

  subroutine read_merge(deck, command, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(t_mesh_type) :: mesh
    type(t_spline_type) :: spline
    type(sweep_type), allocatable :: sweep
    type(record) :: rec
    character(:), allocatable :: name
    integer :: continuity, error_count, part(2), side(2), k
    real(wp) :: seam, tolerance
    logical :: more

    error_count = log%error_count()
    call command%text(2, name, log, 'name of the merged patch')
    if (find_set(model, name) > 0) call command%add_error(log, 'the name ' // quoted(name) // ' is taken', &
      'See ' // model%sets(find_set(model, name))%place, 2)
    do k = 1, 2
      call read_edge(command, 2 + k, draft, part(k), side(k), log)
    end do
    call read_options(command, continuity, tolerance, log)
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      if (rec%key(1) == 'swee') then
        call read_sweep(rec, model%ndm, sweep, log)
      else
        call rec%add_error(log, 'unknown line ' // quoted(rec%word(1)), 'MERGe has the line SWEEp; refine the patches before')
      end if
    end do
    if (all(part > 0) .and. log%error_count() == error_count) &
      call merge_parts(command, draft, part, side, continuity, tolerance, mesh, spline, seam, log)
    if (log%error_count() == error_count .and. all(part > 0)) then
      call add_to_model(command, name, part, side, mesh, spline, sweep, seam, model, draft, log)
    else
      draft%has_lost_sets = .true.
      call add_empty_sets(name, in_place(command%at), model)
      do k = 1, 2
        if (part(k) > 0) call add_empty_sets(draft%parts(part(k))%name, in_place(command%at), model)
      end do
    end if
  end subroutine read_merge

  subroutine add_empty_sets(name, place, model)
    !! After an error the sets of a patch are known all the same, so that there is no second message for each use of them.
    character(*), intent(in) :: name, place
    type(model_type), intent(inout) :: model
    integer :: s

    if (find_set(model, name) > 0) return
    call add_set(model, name, place, set_elements, [integer ::], [integer ::])
    do s = 1, 4
      call add_set(model, name // '.' // trim(surface_sides(s)), place, set_surface, [integer ::], [integer ::])
    end do
  end subroutine add_empty_sets

  subroutine read_edge(command, i, draft, part, side, log)
    !! PATCH.side.
    type(record), intent(in) :: command
    integer, intent(in) :: i                   !! item
    type(draft_type), intent(inout) :: draft
    integer, intent(out) :: part, side         !! of the edge; 0 after an error
    type(message_log), intent(inout) :: log
    type(string), allocatable :: names(:)
    character(:), allocatable :: edge
    integer :: dot, k

    part = 0
    side = 0
    call command%text(i, edge, log, 'edge')
    if (len(edge) == 0) return
    dot = index(edge, '.', back=.true.)
    do k = 1, 4
      if (lower_case(edge(dot + 1:)) == surface_sides(k)) side = k
    end do
    if (dot == 0 .or. side == 0) then
      call command%add_error(log, quoted(edge) // ' is not an edge', &
        'Write PATCH.SIDE. ' // known_names(surface_sides, 'sides'), i)
      return
    end if
    part = draft%find_part(edge(1:dot - 1))
    if (part == 0) then
      if (draft%has_lost_sets) return        ! perhaps for want of this patch
      allocate (names(size(draft%parts)))
      do k = 1, size(names)
        names(k)%s = draft%parts(k)%name
      end do
      call command%add_error(log, 'there is no patch ' // quoted(edge(1:dot - 1)) // ' with the line PARTial', &
        known_names(names, 'patches with PARTial'), i)
    else if (draft%parts(part)%is_taken) then
      call command%add_error(log, 'the patch ' // quoted(edge(1:dot - 1)) // ' is merged already', &
        'MERGe joins two patches, each patch is taken once', i)
      part = 0
    else
      draft%parts(part)%is_taken = .true.
    end if
  end subroutine read_edge

  subroutine read_options(command, continuity, tolerance, log)
    type(record), intent(in) :: command
    integer, intent(out) :: continuity
    real(wp), intent(out) :: tolerance         !! [length], -1: not given
    type(message_log), intent(inout) :: log
    character(:), allocatable :: word

    continuity = 0
    tolerance = -1
    call command%check_options([character(9) :: 'tolerance'], log)
    call command%number_option('tolerance', tolerance, log)
    if (command%has('tolerance') .and. .not. tolerance >= 0) &
      call command%add_error(log, 'the tolerance is a length', 'Write TOLerance=1e-9, or leave it out')
    if (command%count < 5 .or. command%key(5) == 'tole') return
    word = lower_case(command%word(5))
    if (len(word) == 2) continuity = index('0123456789', word(2:2)) - 1
    if (len(word) /= 2 .or. word(1:1) /= 'c' .or. continuity < 0) then
      call command%add_error(log, 'unknown continuity ' // quoted(command%word(5)), 'Write C0, C1 or C2', 5)
      continuity = 0
    end if
  end subroutine read_options

  subroutine merge_parts(command, draft, part, side, continuity, tolerance, mesh, spline, seam, log)
    type(record), intent(in) :: command
    type(draft_type), intent(in) :: draft
    integer, intent(in) :: part(2), side(2), continuity
    real(wp), intent(in) :: tolerance
    type(t_mesh_type), intent(out) :: mesh
    type(t_spline_type), intent(out) :: spline
    real(wp), intent(out) :: seam
    type(message_log), intent(inout) :: log
    type(nurbs_patch_type) :: turned(2)
    integer :: error_count, k, status
    real(wp) :: gap, allowed, size_of_both

    seam = 0
    error_count = log%error_count()
    do k = 1, 2
      associate (patch => draft%parts(part(k))%patch)
        if (patch%dp /= 2) then
          call command%add_error(log, 'the patch ' // quoted(draft%parts(part(k))%name) // ' is no surface', &
            'MERGe takes patches of two directions; for a solid add SWEEp to MERGe', 2 + k)
          return
        end if
        turned(k) = turned_patch(patch, merge(side(k), opposite(side(k)), k == 1))
        if (any(mod(patch%knots(1:2)%p, 2) == 0)) call command%add_error(log, 'a T-spline has odd degrees', &
          'ELEVate the patch ' // draft%parts(part(k))%name // ' to degree 1, 3 or 5 in each direction first', 2 + k)
      end associate
    end do
    if (log%error_count() > error_count) return
    if (any(turned(1)%knots(1:2)%p /= turned(2)%knots(1:2)%p)) then
      call command%add_error(log, 'the degrees across and along the edge are ' // degrees(turned(1)) // ' and ' &
        // degrees(turned(2)), 'ELEVate the patches to the same degrees')
      return
    end if
    if (continuity > turned(1)%knots(1)%p - 1) then
      call command%add_error(log, 'degree ' // whole_text(turned(1)%knots(1)%p) // ' across the edge allows C' &
        // whole_text(turned(1)%knots(1)%p - 1) // ' at most', 'ELEVate the patches, or ask for less', 5)
      return
    end if
    size_of_both = 0
    do k = 1, 2
      size_of_both = max(size_of_both, norm2(maxval(turned(k)%cp(1:3, :), 2) - minval(turned(k)%cp(1:3, :), 2)))
    end do
    allowed = merge(tolerance, 1e-9_wp*size_of_both, tolerance >= 0)
    call merge_patches(draft%parts(part(1))%patch, side(1), draft%parts(part(2))%patch, side(2), continuity, allowed, &
      mesh, spline, seam, gap, status)
    if (status == edges_differ) then
      call command%add_error(log, 'the edges are not the same curve: their control points on all knots are ' &
        // write_number(gap) // ' apart', 'Check the sides, and that both edges have the same parameters and weights; ' &
        // 'TOLerance allows for more than ' // write_number(allowed))
    else if (status /= ok) then
      call command%add_error(log, status_text(status), 'Both patches need open knot vectors')
    else
      call report_suitability(command, mesh, log)
    end if
  end subroutine merge_parts

  function degrees(patch) result(text)
    type(nurbs_patch_type), intent(in) :: patch
    character(:), allocatable :: text

    text = whole_text(patch%knots(1)%p) // ' x ' // whole_text(patch%knots(2)%p)
  end function degrees

  subroutine add_to_model(command, name, part, side, mesh, spline, sweep, seam, model, draft, log)
    type(record), intent(in) :: command
    character(*), intent(in) :: name
    integer, intent(in) :: part(2), side(2)
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    type(sweep_type), allocatable, intent(in) :: sweep
    real(wp), intent(in) :: seam                !! parameter s between both
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(t_body) :: made
    character(:), allocatable :: place
    integer, allocatable :: items(:)
    logical, allocatable :: belongs(:)
    integer :: e, k, s, status, turned_side

    place = in_place(command%at)
    call begin_origin(draft, command, 'MERGe', name)
    call add_t_body(mesh, spline, sweep, model, draft, made, status)
    if (status /= ok) then
      call command%add_error(log, status_text(status), '')
      return
    end if
    call draft%note_elements(made%first, made%last, draft%parts(part(1))%material, draft%parts(part(1))%body, command%at)
    call add_set(model, name, place, set_elements, made%all_elements(), [integer ::])
    allocate (belongs(made%first:made%last))
    do k = 1, 2
      items = made%through_layers(pack([(e, e=1, made%surface%ne)], &
        (made%surface%lo(1, :) + made%surface%hi(1, :))/2 < seam .eqv. k == 1))
      do e = 1, size(items)
        call draft%note_elements(items(e), items(e), draft%parts(part(k))%material, draft%parts(part(k))%body, command%at)
      end do
      belongs = .false.
      belongs(items) = .true.
      call add_set(model, draft%parts(part(k))%name, place, set_elements, items, [integer ::])
      turned_side = merge(side(k), opposite(side(k)), k == 1)
      do s = 1, 4
        if (side_before(s, turned_side) == side(k)) cycle
        items = made%elements_on(s)
        call made%add_surface(draft%parts(part(k))%name // '.' // trim(surface_sides(side_before(s, turned_side))), place, s, &
          pack(items, belongs(items)), model)
      end do
    end do
    draft%origins(size(draft%origins))%last = made%last
    if (.not. allocated(sweep)) return
    call made%add_surface(name // '.back', place, 5, made%elements_on(5), model)
    call made%add_surface(name // '.front', place, 6, made%elements_on(6), model)
  end subroutine add_to_model

  subroutine check_parts(model, draft, log)
    !! Patches with PARTial that nothing takes are not in the mesh: that is hardly meant.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer :: i

    if (draft%has_lost_sets) return
    do i = 1, size(draft%parts)
      if (draft%parts(i)%is_taken) cycle
      call log%add_error(draft%parts(i)%at, 'PATCh', 'the patch ' // quoted(draft%parts(i)%name) &
        // ' is PARTial, but no MERGe takes it', 'Remove PARTial, or merge the patch')
      call add_empty_sets(draft%parts(i)%name, in_place(draft%parts(i)%at), model)
      draft%has_lost_sets = .true.
    end do
  end subroutine check_parts
end module merge_commands
