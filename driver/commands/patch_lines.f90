module patch_lines
  !! The lines of a PATCh data set: what makes a patch, refines, converts and moves it.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use messages, only: message_log, whole_text, quoted, known_names
  use number_text, only: write_number
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use data_lines, only: next_line
  use knot_vectors, only: knot_vector, knot_status
  use nurbs_patch, only: nurbs_patch_type, create_patch
  use nurbs_refinement, only: elevate_degree, insert_knots, subdivide
  use grading, only: uniform_breaks, graded_breaks, symmetric_breaks, fitted_breaks
  use lagrange, only: equispaced, lobatto
  use t_mesh, only: t_mesh_type
  use t_sweep, only: sweep_type
  use t_patch_lines, only: begin_t_mesh, carry_out_t_line, t_line_words
  implicit none (type, external)
  private
  public :: patch_draft, carry_out_line

  integer, parameter :: largest_degree = 20
  integer, parameter :: most_elements = 10000000   !! of a patch: more is a slip, and no memory holds it

  type :: patch_draft
    integer :: dp = 0                       !! directions, 0: DEGRee is missing
    type(knot_vector) :: knots(3)
    logical :: has_knots(3) = .false.
    logical :: is_built = .false.           !! degrees, knots and points are there
    type(nurbs_patch_type) :: patch
    logical :: is_lagrange = .false.
    integer :: degree(3) = 0                !! of the Lagrange elements
    integer :: nodes = equispaced
    logical :: is_t = .false.               !! refined locally or swept
    logical :: is_part = .false.            !! of a T-spline that MERGe makes
    type(t_mesh_type) :: mesh
    type(sweep_type), allocatable :: sweep
  end type patch_draft

contains

  subroutine carry_out_line(deck, rec, ndm, new, log)
    !! One line of the data set.
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    character(4) :: word
    integer :: error_count

    word = rec%key(1)
    select case (word)
    case ('degr', 'knot', 'poin')
      if (new%is_built) then
        call rec%add_error(log, rec%word(1) // ' after the control points', &
          'The order is DEGRee, KNOTs for each direction, POINts, then refinements')
        return
      end if
    case ('elev', 'inse', 'subd', 'lagr', 'rota', 'tran', 'scal', 'refi', 'rows', 'spli', 'suit', 'swee', 'part')
      if (.not. new%is_built) then
        call rec%add_error(log, rec%word(1) // ' before the control points', &
          'The order is DEGRee, KNOTs for each direction, POINts, then refinements')
        return
      else if (new%is_lagrange .and. any(word == ['elev', 'inse', 'subd', 'lagr'])) then
        call rec%add_error(log, rec%word(1) // ' after LAGRange', &
          'Refine the patch before it becomes Lagrange elements')
        return
      else if (new%is_t .and. any(word == ['elev', 'inse', 'subd', 'lagr'])) then
        call rec%add_error(log, rec%word(1) // ' after local refinement', &
          'Elevate and subdivide the patch first, then refine it locally')
        return
      else if (new%is_part .and. any(word == ['lagr', 'refi', 'rows', 'spli', 'suit', 'swee'])) then
        call rec%add_error(log, rec%word(1) // ' of a patch that is PARTial', &
          'Only NURBS patches are merged; SWEEp stands in the data set of MERGe')
        return
      else if (word == 'part' .and. (new%is_lagrange .or. new%is_t)) then
        call rec%add_error(log, 'the patch is no NURBS patch any more', &
          'MERGe takes patches without LAGRange, local refinement and SWEEp')
        return
      else if (new%is_lagrange .and. any(word == ['refi', 'rows', 'spli', 'suit', 'swee'])) then
        call rec%add_error(log, rec%word(1) // ' of Lagrange elements', &
          'T-splines and sweeps are made from the patch: remove LAGRange')
        return
      end if
    end select
    select case (word)
    case ('degr'); call read_degrees(rec, new, log)
    case ('knot'); call read_knots(rec, new, log)
    case ('poin'); call read_points(deck, rec, ndm, new, log)
    case ('elev'); call read_elevation(rec, new, log)
    case ('inse'); call read_insertion(rec, new, log)
    case ('subd'); call read_subdivision(rec, new, log)
    case ('lagr'); call read_lagrange(rec, new, log)
    case ('rota', 'tran', 'scal'); call move_points(rec, ndm, new%patch, log)
    case ('refi', 'rows', 'spli', 'suit', 'swee')
      error_count = log%error_count()
      if (.not. new%is_t) call begin_t_mesh(rec, new%patch, new%mesh, log)
      new%is_t = log%error_count() == error_count
      if (new%is_t) call carry_out_t_line(rec, ndm, new%patch, new%mesh, new%sweep, log)
    case ('part')
      call rec%check_count(1, 1, log, 'PARTial alone')
      new%is_part = .true.
    case default
      call rec%add_error(log, 'unknown line ' // quoted(rec%word(1)), &
        known_names([character(9) :: 'DEGRee', &
        'KNOTs', 'POINts', 'ELEVate', 'INSErt', 'SUBDivide', 'LAGRange', 'ROTAte', 'TRANslate', &
        'SCALe', t_line_words, 'PARTial'], 'lines'))
    end select
  end subroutine carry_out_line

  subroutine read_degrees(rec, new, log)
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    integer :: d, p(3)

    call rec%check_count(2, 4, log, 'DEGRee and the degree of each direction')
    if (rec%count < 2 .or. rec%count > 4) return
    new%dp = rec%count - 1
    call rec%integers(2, p(1:new%dp), log, 'degrees')
    do d = 1, new%dp
      new%knots(d)%p = p(d)
      if (p(d) < 1 .or. p(d) > largest_degree) call rec%add_error(log, 'the degree ' // &
        whole_text(p(d)) // &
        ' is not possible', 'Degrees are 1 to ' // whole_text(largest_degree), d + 1)
    end do
  end subroutine read_degrees

  subroutine read_knots(rec, new, log)
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    integer :: d, i
    real(wp), allocatable :: u(:)

    call read_direction(rec, new, d, log)
    if (d == 0) return
    allocate (u(rec%count - 2))
    call rec%numbers(3, u, log, 'knots')
    new%knots(d)%u = u
    new%has_knots(d) = .true.
    do i = 2, size(u)
      if (u(i) >= u(i - 1)) cycle
      call rec%add_error(log, 'the knots decrease from ' // write_number(u(i - 1)) // ' to ' // &
        write_number(u(i)), &
        'A knot vector never decreases', i + 2)
      return
    end do
    if (size(u) < 2*new%knots(d)%p + 2) then
      call rec%add_error(log, whole_text(size(u)) // ' knots are too few', 'Degree ' // &
        whole_text(new%knots(d)%p) // ' needs at least ' // whole_text(2*new%knots(d)%p + 2))
    else if (knot_status(new%knots(d)) /= ok) then
      call rec%add_error(log, status_text(knot_status(new%knots(d))), &
        'Degree p allows p+1 equal knots')
    end if
  end subroutine read_knots

  subroutine read_direction(rec, new, d, log)
    !! Item 2: a direction of the patch.
    type(record), intent(in) :: rec
    type(patch_draft), intent(in) :: new
    integer, intent(out) :: d                 !! 0 after an error
    type(message_log), intent(inout) :: log

    if (new%dp == 0) then
      call rec%add_error(log, 'the degrees are not known yet', 'DEGRee stands first')
      d = 0
      return
    end if
    call rec%integer(2, d, log, 'direction')
    if (d >= 1 .and. d <= new%dp) return
    call rec%add_error(log, 'there is no direction ' // quoted(rec%word(2)), 'The patch has ' // &
      whole_text(new%dp) // ' directions', 2)
    d = 0
  end subroutine read_direction

  subroutine read_points(deck, rec, ndm, new, log)
    !! The lines after POINts: x y [z] [w], first direction fastest.
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    real(wp), allocatable :: cp(:, :)
    integer :: a, error_count, n, status
    logical :: more

    error_count = log%error_count()
    if (new%dp == 0 .or. .not. all(new%has_knots(1:new%dp))) then
      call rec%add_error(log, 'degrees or knots are missing', &
        'Give DEGRee and KNOTs for each direction before POINts')
      return
    end if
    n = 1
    do a = 1, new%dp
      n = n*new%knots(a)%functions()
    end do
    allocate (cp(4, n), source=0.0_wp)
    do a = 1, n
      call next_line(deck, rec, log, more)
      if (.not. more) then
        call rec%add_error(log, 'the patch has ' // whole_text(a - 1) // ' points', &
          'Its knots need ' // whole_text(n))
        return
      end if
      call rec%check_count(ndm, ndm + 1, log, 'coordinates and weight of a point')
      if (rec%count < ndm) return
      call rec%numbers(1, cp(1:ndm, a), log, 'coordinates')
      call rec%number(ndm + 1, cp(4, a), log, 'weight', 1.0_wp)
      if (log%error_count() > error_count) return
      if (cp(4, a) > 0) cycle
      call rec%add_error(log, 'the weight of point ' // whole_text(a) // ' is ' // &
        write_number(cp(4, a)), &
        'Weights must be positive')
      return
    end do
    call create_patch(new%knots(1:new%dp), cp, new%patch, status)
    if (status /= ok) call rec%add_error(log, status_text(status), '')
    new%is_built = status == ok
  end subroutine read_points

  subroutine read_elevation(rec, new, log)
    !! ELEVate dir times | ELEVate TO p q [r].
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    integer :: d, times, p(3)

    if (rec%key(2) == 'to') then
      call rec%check_count(2 + new%dp, 2 + new%dp, log, &
        'ELEVate TO and a degree for each direction')
      if (rec%count /= 2 + new%dp) return
      call rec%integers(3, p(1:new%dp), log, 'degrees')
      do d = 1, new%dp
        if (p(d) < new%patch%knots(d)%p .or. p(d) > largest_degree) then
          call rec%add_error(log, 'direction ' // whole_text(d) // &
            ' cannot be elevated from degree ' // &
            whole_text(new%patch%knots(d)%p) // ' to ' // whole_text(p(d)), &
            'The degree only rises, to ' // whole_text(largest_degree) // ' at most', 2 + d)
        else
          call elevate_degree(new%patch, d, p(d) - new%patch%knots(d)%p)
        end if
      end do
      return
    end if
    call read_direction(rec, new, d, log)
    if (d == 0) return
    call rec%integer(3, times, log, 'number of elevations', 1)
    if (times < 0 .or. new%patch%knots(d)%p + times > largest_degree) then
      call rec%add_error(log, 'the degree ' // whole_text(new%patch%knots(d)%p) // &
        ' cannot rise by ' // &
        whole_text(times), 'Degrees are 1 to ' // whole_text(largest_degree), 3)
      return
    end if
    call elevate_degree(new%patch, d, times)
  end subroutine read_elevation

  subroutine read_insertion(rec, new, log)
    !! INSErt dir u1 u2 ...
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    real(wp), allocatable :: u(:)
    integer :: d, status

    call read_direction(rec, new, d, log)
    if (d == 0) return
    allocate (u(rec%count - 2))
    call rec%numbers(3, u, log, 'knots')
    call insert_knots(new%patch, d, u, status)
    if (status /= ok) call rec%add_error(log, 'these knots cannot be inserted', &
      'They lie inside the domain, and none is repeated more than p+1 times')
  end subroutine read_insertion

  subroutine read_subdivision(rec, new, log)
    !! SUBDivide dir n [RATIo=r | BOTH=r]: n elements in all; lengths of the last to the first, or
    !! of the middle to the ends. Breaks that exist are kept.
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    real(wp), allocatable :: old(:), ideal(:)
    real(wp) :: ratio, both, others(3)       ! elements in the other directions
    integer :: d, m, n, status
    logical :: to_one_end, to_both_ends

    call read_direction(rec, new, d, log)
    if (d == 0) return
    call rec%integer(3, n, log, 'number of elements')
    ratio = 1
    both = 1
    to_one_end = rec%has('ratio')
    to_both_ends = rec%has('both')
    call rec%number_option('ratio', ratio, log)
    call rec%number_option('both', both, log)
    call rec%check_options([character(5) :: 'ratio', 'both'], log)
    allocate (old, source=new%patch%knots(d)%breaks())
    m = size(old)
    others = new%patch%elements()
    others(d) = 1
    if (n < m - 1 .or. n < 1) then
      call rec%add_error(log, 'direction ' // whole_text(d) // ' has ' // whole_text(m - 1) // &
        ' elements already', 'The number is that of all elements in this direction', 3)
      return
    else if (real(n, wp)*product(others(:new%dp)) > most_elements) then
      call rec%add_error(log, 'the patch would have more than ' // whole_text(most_elements) // ' elements', &
        'The number is that of all elements in this direction', 3)
      return
    else if (.not. (ratio > 0 .and. both > 0)) then
      call rec%add_error(log, 'a ratio of element lengths must be positive', '')
      return
    else if (to_one_end .and. to_both_ends) then
      call rec%add_error(log, 'RATIo and BOTH exclude each other', &
        'RATIo grades to one end, BOTH to both')
      return
    else if (to_one_end) then
      allocate (ideal, source=graded_breaks(old(1), old(m), n, ratio))
    else if (to_both_ends) then
      allocate (ideal, source=symmetric_breaks(old(1), old(m), n, both))
    else
      allocate (ideal, source=uniform_breaks(old(1), old(m), n))
    end if
    call subdivide(new%patch, d, fitted_breaks(old, ideal), status)
    if (status /= ok) call rec%add_error(log, 'some elements would be shorter than rounding', &
      'Grade less')
  end subroutine read_subdivision

  subroutine read_lagrange(rec, new, log)
    !! LAGRange p q [r] [LOBAtto].
    type(record), intent(in) :: rec
    type(patch_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    integer :: d

    call rec%check_count(1 + new%dp, 2 + new%dp, log, &
      'LAGRange, a degree for each direction, LOBAtto')
    if (rec%count < 1 + new%dp) return
    call rec%integers(2, new%degree(1:new%dp), log, 'degrees')
    do d = 1, new%dp
      if (new%degree(d) < 1 .or. new%degree(d) > largest_degree) call rec%add_error(log, &
        'the degree ' // &
        whole_text(new%degree(d)) // ' is not possible', 'Degrees are 1 to ' // &
        whole_text(largest_degree), d + 1)
    end do
    if (rec%count == 2 + new%dp) then
      if (rec%key(2 + new%dp) == 'loba') then
        new%nodes = lobatto
      else
        call rec%add_error(log, 'unknown kind of nodes ' // quoted(rec%word(2 + new%dp)), &
          'LOBAtto, or nothing for equispaced nodes', 2 + new%dp)
      end if
    end if
    new%is_lagrange = .true.
  end subroutine read_lagrange

  subroutine move_points(rec, ndm, patch, log)
    !! ROTAte angle x0 y0 (degrees, about z) | TRANslate dx dy [dz] | SCALe s.
    type(record), intent(in) :: rec
    integer, intent(in) :: ndm
    type(nurbs_patch_type), intent(inout) :: patch
    type(message_log), intent(inout) :: log
    real(wp) :: v(3), x(2), c, s
    integer :: a
    real(wp), parameter :: degree = acos(-1.0_wp)/180

    v = 0
    select case (rec%key(1))
    case ('rota')
      call rec%number(2, v(1), log, 'angle')
      call rec%number(3, v(2), log, 'centre', 0.0_wp)
      call rec%number(4, v(3), log, 'centre', 0.0_wp)
      c = cos(v(1)*degree)
      s = sin(v(1)*degree)
      do a = 1, size(patch%cp, 2)
        x = patch%cp(1:2, a) - v(2:3)
        patch%cp(1:2, a) = v(2:3) + [c*x(1) - s*x(2), s*x(1) + c*x(2)]
      end do
    case ('tran')
      call rec%numbers(2, v(1:ndm), log, 'components')
      do a = 1, size(patch%cp, 2)
        patch%cp(1:3, a) = patch%cp(1:3, a) + v
      end do
    case default
      call rec%number(2, v(1), log, 'factor')
      if (.not. v(1) > 0) call rec%add_error(log, 'the factor must be positive', '', 2)
      patch%cp(1:3, :) = v(1)*patch%cp(1:3, :)
    end select
  end subroutine move_points
end module patch_lines
