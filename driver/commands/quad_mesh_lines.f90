module quad_mesh_lines
  !! The lines of a QUADmesh data set, and the file that it may name (see quad_mesh_commands).
  use kinds, only: wp
  use messages, only: message_log, quoted, whole_text, known_names
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use data_lines, only: next_line
  use spline_commands, only: beside
  use mesh_files, only: report_problems
  use file_system, only: file_exists, folder_exists
  use extraction_file, only: load_text
  use extraction_mesh, only: problem_list
  use obj_reader, only: read_obj
  use quad_mesh_draft, only: quad_draft
  use refinement_zones, only: zone_type
  use growing_arrays, only: make_room
  use t_patch_lines, only: read_sweep
  implicit none (type, external)
  private
  public :: read_quad_file, carry_out_quad_line

  integer, parameter :: most_refinements = 10, most_levels = 6

contains

  subroutine read_quad_file(command, file, ndm, new, log)
    type(record), intent(in) :: command
    character(*), intent(in) :: file
    integer, intent(in) :: ndm
    type(quad_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    type(problem_list) :: problems
    character(:), allocatable :: message, path, text
    real(wp), allocatable :: x(:, :)
    integer, allocatable :: first(:), line(:), vertex(:)
    logical :: good

    path = beside(command%at%file, file)
    good = file_exists(path)
    if (good) good = .not. folder_exists(path)
    if (.not. good) then
      call command%add_error(log, 'there is no file ' // quoted(path), 'The name is relative to the deck; put it in quotes')
      return
    end if
    call load_text(path, text, good)
    if (.not. good) then
      call command%add_error(log, 'the file ' // quoted(path) // ' cannot be read', '')
      return
    end if
    call read_obj(text, x, first, vertex, line, problems)
    if (problems%count == 0) then
      call new%set_faces(x, first, vertex, message)
      if (len(message) > 0) call problems%add(0, message, '')
      if (ndm == 2 .and. size(x) > 0) then
        if (any(abs(x(3, :)) > 0)) call problems%add(0, 'a vertex of a deck in the plane has z /= 0', &
          'Let ndm be 3 in the deck, or correct the file')
      end if
    end if
    call report_problems(problems, path, 'QUADmesh', command%at%order, log)
    if (problems%count > 0) new%is_built = .false.
  end subroutine read_quad_file

  subroutine carry_out_quad_line(deck, rec, ndm, new, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(quad_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    character(:), allocatable :: message
    integer, allocatable :: v(:)
    integer :: i
    real(wp) :: length, values(4)

    select case (rec%key(1))
    case ('vert', 'face')
      if (new%is_built) then
        call rec%add_error(log, 'the mesh has its faces already', 'They come from FILE or from VERTices and FACEs, once')
      else if (rec%key(1) == 'vert') then
        call read_vertices(deck, rec, ndm, new, log)
      else
        call read_faces(deck, rec, new, log)
      end if
      return
    case ('crea', 'inte', 'refi', 'sphe', 'swee', 'tran', 'rota', 'scal')
      if (.not. new%is_built) then
        call rec%add_error(log, 'the mesh has no faces yet', 'Give FILE="name.obj", or VERTices and FACEs first')
        return
      end if
    end select
    message = ''
    select case (rec%key(1))
    case ('crea')
      call rec%check_count(3, huge(1), log, 'CREAse and two or more vertices')
      if (rec%count < 3) return
      allocate (v(rec%count - 1))
      call rec%integers(2, v, log, 'vertices')
      do i = 2, size(v)
        call new%set_crease_edge(v(i-1), v(i), message)
        if (len(message) > 0) exit
      end do
    case ('inte')
      call rec%check_count(4, 4, log, 'INTErval, two vertices and a length')
      if (rec%count /= 4) return
      allocate (v(2))
      call rec%integers(2, v, log, 'vertices')
      call rec%number(4, length, log, 'length')
      call new%set_edge_interval(v(1), v(2), length, message)
    case ('refi')
      call read_refinement(rec, ndm, new, message, log)
    case ('sphe')
      call rec%check_count(5, 6, log, 'SPHEre, its centre and its radius [SYMMetric]')
      if (rec%count < 5 .or. rec%count > 6) return
      if (rec%count == 6) then
        if (rec%key(6) /= 'symm') call rec%add_error(log, 'unknown word ' // quoted(rec%word(6)), &
          'Behind the radius only SYMMetric may stand')
        new%is_symmetric = .true.
      end if
      call rec%numbers(2, values, log, 'centre and radius')
      new%sphere%centre = values(1:3)
      new%sphere%radius = values(4)
      new%on_sphere = .true.
      if (ndm < 3) message = 'a mesh in the plane follows no sphere'
      if (.not. values(4) > 0) message = 'the radius is not positive'
    case ('swee')
      call read_sweep(rec, ndm, new%sweep, log)
    case ('tran', 'rota', 'scal')
      if (new%has_t_junctions) then
        call move_vertices(rec, ndm, new%t_mesh%x, log)
      else
        call move_vertices(rec, ndm, new%mesh%x, log)
      end if
    case default
      call rec%add_error(log, 'unknown line ' // quoted(rec%word(1)), known_names([character(9) :: 'VERTices', 'FACEs', &
        'CREAse', 'INTErval', 'TRANslate', 'ROTAte', 'SCALe', 'REFIne', 'SPHEre', 'SWEEp'], 'lines'))
    end select
    if (len(message) > 0) call rec%add_error(log, message, '')
  end subroutine carry_out_quad_line

  subroutine read_refinement(rec, ndm, new, message, log)
    !! REFIne n, or BOX or VERTex with LEVEls.
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(quad_draft), intent(inout) :: new
    character(:), allocatable, intent(inout) :: message
    type(message_log), intent(inout) :: log
    type(zone_type) :: zone
    real(wp) :: bounds(6)
    integer :: error_count, last, v

    error_count = log%error_count()
    if (rec%key(2) /= 'box' .and. rec%key(2) /= 'vert') then
      call rec%check_count(2, 2, log, 'REFIne and how many times, or BOX or VERTex')
      if (rec%count == 2) call rec%integer(2, new%refinements, log, 'how many times')
      if (new%refinements < 0 .or. new%refinements > most_refinements) message = 'a mesh is refined 0 to ' // &
        whole_text(most_refinements) // ' times'
      return
    end if
    zone%levels = 1
    call rec%check_options([character(8) :: 'distance', 'levels'], log)
    call rec%integer_option('levels', zone%levels, log)
    if (zone%levels < 0 .or. zone%levels > most_levels) message = 'LEVEls are 0 to ' // whole_text(most_levels)
    if (rec%key(2) == 'box') then
      bounds = [-1, 1, -1, 1, -1, 1]*huge(1.0_wp)
      last = rec%count
      if (rec%has('levels')) last = rec%find('levels') - 2
      if (last /= 2 + 2*ndm) message = 'BOX needs lower and upper bound of each coordinate'
      if (len(message) > 0 .or. log%error_count() > error_count) return
      call rec%numbers(3, bounds(1:2*ndm), log, 'bounds')
      zone%low = bounds(1::2)
      zone%high = bounds(2::2)
    else
      zone%is_ball = .true.
      call rec%integer(3, v, log, 'vertex')
      call rec%number_option('distance', zone%radius, log)
      if (.not. zone%radius > 0) message = 'the DISTance from the vertex is missing or not positive'
      if (log%error_count() > error_count) return
      call new%find_vertex(v, zone%centre, message)
      if (len(message) > 0) return
    end if
    if (new%has_t_junctions) message = 'a mesh with T-junctions is not refined locally: let its faces be smaller there'
    if (log%error_count() == error_count .and. len(message) == 0) call new%zones%add(zone)
  end subroutine read_refinement

  subroutine read_vertices(deck, rec, ndm, new, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    integer, intent(in) :: ndm
    type(quad_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    integer :: a, error_count, n

    error_count = log%error_count()
    call read_count(rec, n, log)
    if (n == 0) return
    allocate (new%x(3, n), source=0.0_wp)
    do a = 1, n
      if (.not. has_line(deck, rec, a, n, log)) return
      call rec%check_count(ndm, ndm, log, 'coordinates of a vertex')
      if (rec%count == ndm) call rec%numbers(1, new%x(1:ndm, a), log, 'coordinates')
      if (log%error_count() > error_count) return
    end do
  end subroutine read_vertices

  subroutine read_faces(deck, rec, new, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    type(quad_draft), intent(inout) :: new
    type(message_log), intent(inout) :: log
    type(record) :: command
    character(:), allocatable :: message
    integer, allocatable :: first(:), vertex(:)
    integer :: a, error_count, n

    error_count = log%error_count()
    command = rec
    if (.not. allocated(new%x)) then
      call rec%add_error(log, 'faces need vertices', 'Give VERTices before FACEs')
      return
    end if
    call read_count(rec, n, log)
    if (n == 0) return
    allocate (first(n + 1), vertex(0))
    first(1) = 1
    do a = 1, n
      if (.not. has_line(deck, rec, a, n, log)) return
      if (rec%count < 4) call rec%add_error(log, 'face ' // whole_text(a) // ' has ' // whole_text(rec%count) // &
        ' vertices', 'All faces need four corners')
      first(a + 1) = first(a) + rec%count
      call make_room(vertex, first(a + 1))
      call rec%integers(1, vertex(first(a):first(a + 1) - 1), log, 'vertices of a face')
      if (log%error_count() > error_count) return
    end do
    call new%set_faces(new%x, first, vertex(1:first(n + 1) - 1), message)
    if (len(message) > 0) call command%add_error(log, message, '')
  end subroutine read_faces

  subroutine read_count(rec, n, log)
    type(record), intent(in) :: rec
    integer, intent(out) :: n                  !! lines that follow, 0 after an error
    type(message_log), intent(inout) :: log
    integer :: error_count

    error_count = log%error_count()
    n = 0
    call rec%check_count(2, 2, log, 'the word and the number of lines that follow')
    if (rec%count == 2) call rec%integer(2, n, log, 'number of lines')
    if (log%error_count() == error_count .and. n < 1) call rec%add_error(log, 'the number of lines is not positive', '')
    if (log%error_count() > error_count) n = 0
  end subroutine read_count

  logical function has_line(deck, rec, a, n, log) result(more)
    type(deck_type), intent(inout) :: deck
    type(record), intent(inout) :: rec
    integer, intent(in) :: a, n                !! this line, lines announced
    type(message_log), intent(inout) :: log

    call next_line(deck, rec, log, more)
    if (.not. more) call rec%add_error(log, whole_text(a - 1) // ' lines follow, ' // whole_text(n) // ' are announced', &
      'Correct the number, or leave out the blank line')
  end function has_line

  subroutine move_vertices(rec, ndm, x, log)
    !! TRANslate dx dy [dz] | ROTAte angle [ax ay az] | SCALe s
    type(record), intent(in) :: rec
    integer, intent(in) :: ndm
    real(wp), intent(inout) :: x(:, :)           !! vertices (3,nv)
    type(message_log), intent(inout) :: log
    real(wp) :: angle, axis(3), factor, shift(3), turn(3, 3)
    integer :: a, error_count

    error_count = log%error_count()
    select case (rec%key(1))
    case ('tran')
      shift = 0
      call rec%check_count(1 + ndm, 1 + ndm, log, 'TRANslate and the components of the shift')
      if (rec%count == 1 + ndm) call rec%numbers(2, shift(1:ndm), log, 'shift')
      if (log%error_count() > error_count) return
      do a = 1, size(x, 2)
        x(:, a) = x(:, a) + shift
      end do
    case ('scal')
      call rec%check_count(2, 2, log, 'SCALe and the factor')
      if (rec%count == 2) call rec%number(2, factor, log, 'factor')
      if (log%error_count() > error_count) return
      if (.not. factor > 0) then
        call rec%add_error(log, 'the factor is not positive', '')
        return
      end if
      x = factor*x
    case default
      axis = [0.0_wp, 0.0_wp, 1.0_wp]
      call rec%check_count(2, merge(5, 2, ndm == 3), log, 'ROTAte, an angle in degrees and an axis')
      if (rec%count >= 2) call rec%number(2, angle, log, 'angle')
      if (rec%count == 5) call rec%numbers(3, axis, log, 'axis')
      if (log%error_count() > error_count) return
      if (rec%count /= 2 .and. rec%count /= 5 .or. .not. norm2(axis) > 0) then
        call rec%add_error(log, 'the axis needs three components that are not all 0', 'Write ROTAte angle ax ay az')
        return
      end if
      turn = rotation(angle*acos(-1.0_wp)/180, axis/norm2(axis))
      x = matmul(turn, x)
    end select
  end subroutine move_vertices

  pure function rotation(angle, axis) result(turn)
    !! Rodrigues
    real(wp), intent(in) :: angle                !! [rad]
    real(wp), intent(in) :: axis(3)              !! unit vector
    real(wp) :: turn(3, 3)
    real(wp) :: cross(3, 3)
    integer :: i

    cross = reshape([0.0_wp, axis(3), -axis(2), -axis(3), 0.0_wp, axis(1), axis(2), -axis(1), 0.0_wp], [3, 3])
    turn = sin(angle)*cross + (1 - cos(angle))*matmul(cross, cross)
    do i = 1, 3
      turn(i, i) = turn(i, i) + 1
    end do
  end function rotation
end module quad_mesh_lines
